#pragma once

#include <optional>
#include <string>

#include "services/controller/core/path_follower.h"
#include "services/controller/core/pose_gate.h"

namespace thalweg::controller {

/// Formats why the robot does not move along its path, as for the motion status; empty if it does.
std::string ReasonText(const Motion& motion);

/// Why a pose is refused.
std::string JumpText(const PoseGate::Jump& jump);

/// What is wrong with the stamp of a pose that has just arrived, if it is by another clock than `now`: then
/// it says nothing of where the robot is.
std::optional<std::string> ClockProblem(Time stamp, Time now);

}  // namespace thalweg::controller
