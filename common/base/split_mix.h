#pragma once

#include <cstddef>
#include <cstdint>

namespace thalweg {

/// The generator splitmix64 [Steele, Lea, Flood: Fast splittable pseudorandom number generators, OOPSLA
/// 2014]: the same numbers on every machine, unlike those of the standard distributions.
struct SplitMix {
  std::uint64_t state = 1;

  std::uint64_t Next() {
    state += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }
  std::size_t Below(std::size_t count) { return static_cast<std::size_t>(Next() % count); }
  double Share() { return static_cast<double>(Next() >> 11U) * 0x1.0p-53; }  ///< In [0, 1).
};

}  // namespace thalweg
