#pragma once

#include <string>

#include "services/controller/core/path_follower.h"
#include "services/controller/core/pose_gate.h"

namespace thalweg::controller {

/// Formats why the robot does not move along its path, as for the motion status; empty if it does.
std::string ReasonText(const Motion& motion);

/// Why a pose is refused.
std::string JumpText(const PoseGate::Jump& jump);

}  // namespace thalweg::controller
