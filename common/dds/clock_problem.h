#pragma once

#include <optional>
#include <string>

#include "common/base/time.h"

namespace thalweg::dds {

/// What is wrong with the stamp of a message that has just arrived if it was never set; nothing in the first
/// seconds of a clock that begins at 0.
std::optional<std::string> MissingStamp(Time stamp, Time now);

/// What is wrong with the stamp of a pose that has just arrived, if it is by another clock than `now`: then
/// it says nothing of where the robot is. Not for clouds, which may have waited for a link.
std::optional<std::string> ClockProblem(Time stamp, Time now);

}  // namespace thalweg::dds
