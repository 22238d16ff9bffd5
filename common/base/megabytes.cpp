#include "common/base/megabytes.h"

#include <array>
#include <cstdio>

namespace thalweg {

std::string MegabytesText(double bytes) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.1f MB", Megabytes(bytes));
  return text.data();
}

}  // namespace thalweg
