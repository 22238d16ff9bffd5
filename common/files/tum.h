#pragma once

#include <string>
#include <vector>

#include "common/geometry/timed_pose.h"

namespace thalweg {

/// A trajectory as the TUM RGB-D benchmark and evo have it: one line a pose, "stamp tx ty tz qx qy qz qw"
/// [s, m], after a comment that says so. Stamps to the nanosecond; the shortest decimals that are read back
/// as the same numbers.
std::string TumText(const std::vector<TimedPose>& poses);

}  // namespace thalweg
