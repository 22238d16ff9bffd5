#pragma once

#include <iomanip>
#include <sstream>
#include <string>

namespace thalweg::visual_odometry {

/// Formats a number for messages to people.
inline std::string Fixed(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

}  // namespace thalweg::visual_odometry
