#pragma once

#include <string>

namespace thalweg {

/// A span of time for people, in the unit in which it is easiest to grasp: "0.35 s", "40 s", "12 min", "3 h",
/// "5 days", "57 years".
/// @param seconds  Its sign is ignored.
std::string DurationText(double seconds);

}  // namespace thalweg
