#include "common/base/version.h"

namespace thalweg {

std::string_view Version() {
  return THALWEG_VERSION;
}

}  // namespace thalweg
