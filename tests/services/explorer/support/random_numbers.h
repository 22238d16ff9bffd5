#pragma once

#include <random>

/// Random numbers that are the same with every standard library.
namespace thalweg::explorer::test {

inline int RandomInt(std::mt19937& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
}

inline double RandomDouble(std::mt19937& random, double low, double high) {
  return low + (high - low) * (random() / 4294967296.0);
}

}  // namespace thalweg::explorer::test
