#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace thalweg::visual_odometry {

/// Formats a number for messages to people; "-" if it is NaN or infinite.
inline std::string Fixed(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "-";
}

}  // namespace thalweg::visual_odometry
