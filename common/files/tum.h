#pragma once

#include <string>
#include <vector>

#include "common/geometry/timed_pose.h"

namespace thalweg {

/// Formats a trajectory as used by the TUM RGB-D benchmark and evo: one line per pose, "stamp tx ty tz qx qy
/// qz qw" [s, m], after a comment line that says so. Stamps have nanosecond precision; numbers are the
/// shortest decimals that read back as the same value.
std::string TumText(const std::vector<TimedPose>& poses);

}  // namespace thalweg
