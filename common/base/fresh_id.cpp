#include "common/base/fresh_id.h"

#include <random>

namespace thalweg {

std::uint64_t FreshId() {
  std::random_device random;
  return std::uint64_t{random()} << 32U | random();
}

}  // namespace thalweg
