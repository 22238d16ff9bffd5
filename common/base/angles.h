#pragma once

#include <numbers>

namespace thalweg {

/// [rad] One degree: `90.0 * kDegree` is a right angle, and `angle / kDegree` an angle in degrees.
inline constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace thalweg
