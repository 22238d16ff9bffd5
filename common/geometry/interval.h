#pragma once

#include <algorithm>

namespace thalweg {

/// Distance of a number from the interval [low, high]; 0 within.
constexpr double DistanceToInterval(double x, double low, double high) {
  return std::max({low - x, x - high, 0.0});
}

}  // namespace thalweg
