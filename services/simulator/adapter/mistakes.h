#pragma once

#include <vector>

#include "common/scenario/scenario.h"

namespace thalweg::simulator {

/// Finds what contradicts the presence of the simulator. Only for scenarios that are run with it: a scenario
/// for a robot of one's own may contain all of this.
std::vector<Mistake> MistakesIn(const Scenario& scenario);

}  // namespace thalweg::simulator
