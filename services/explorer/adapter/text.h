#pragma once

#include <string>

#include "services/explorer/core/exploration_loop.h"

namespace thalweg::explorer {

/// What a plan does and why, on one line, for people. Of an ending it says what stayed unknown and why.
/// @param sensor_range  [m] Named where it may be why too much stayed unknown.
std::string PlanText(const Plan& plan, double sensor_range);

/// The same of the loop's plan, or what it waits for.
std::string ActivityText(const ExplorationLoop& loop, double sensor_range);

}  // namespace thalweg::explorer
