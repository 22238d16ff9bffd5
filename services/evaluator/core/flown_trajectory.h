#pragma once

#include <span>

#include "common/geometry/timed_pose.h"
#include "services/evaluator/core/lockstep.h"

namespace thalweg::evaluator {

/// Measures a trajectory that was flown by any program as if one of ours had flown it: straight between its
/// poses, with the scenario's sensor at its rate, mapper, body and truth. Parts that move do so from the
/// first pose on, in a copy of the world.
/// @param T_WBs    Poses of the body with increasing stamps, at least two; throws std::invalid_argument
///                 otherwise. The run's time begins with the first.
/// @param options  Its explorer and own_pose have no effect.
LockstepResult Fly(const simulator::World& world, std::span<const TimedPose> T_WBs,
                   const LockstepOptions& options, mapper::FusedMap& map, const simulator::TrueMap& truth);

}  // namespace thalweg::evaluator
