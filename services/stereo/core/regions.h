#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

namespace thalweg::stereo {

/// Disjoint sets of pixels (union-find), identified by their row-major index.
class Regions {
 public:
  explicit Regions(std::uint32_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }

  std::uint32_t RootOf(std::uint32_t i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }
  void Join(std::uint32_t a, std::uint32_t b) {
    a = RootOf(a);
    b = RootOf(b);
    if (a < b) {
      parent_[b] = a;
    } else {
      parent_[a] = b;
    }
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace thalweg::stereo
