#pragma once

#include <vector>

#include "common/scenario/scenario.h"
#include "services/simulator/core/moving_part.h"

namespace thalweg::simulator {

/// The parts of a scenario's world that move, `world.moving`.
std::vector<MovingPart> MovingPartsFrom(const Scenario& scenario);

}  // namespace thalweg::simulator
