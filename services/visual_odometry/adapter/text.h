#pragma once

#include <string>

#include "services/visual_odometry/core/reason.h"

namespace thalweg::visual_odometry {

/// Formats a number for messages to people; "-" if it is NaN or infinite.
std::string Fixed(double value, int digits);

/// Formats why a pose is doubtful or missing, as for the odometry status; empty if it is neither.
std::string ReasonText(const Reason& reason);

}  // namespace thalweg::visual_odometry
