#include "tests/support/places.h"

namespace thalweg::test {

std::string SourceFolder() {
  return THALWEG_SOURCE_DIR;
}

std::string BinFolder() {
  return THALWEG_BIN_DIR;
}

}  // namespace thalweg::test
