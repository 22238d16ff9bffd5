#pragma once

#include <cstdint>
#include <memory>

#include "services/controller/core/motion_controller.h"
#include "services/controller/core/path_follower.h"

namespace thalweg::controller {

/// How a robot is led along its path.
enum class ControllerType : std::uint8_t { kPathFollower, kStopAndTurn };

/// Throws std::invalid_argument naming the invalid option.
std::unique_ptr<MotionController> MakeController(ControllerType type, const PathFollower::Options& options);

}  // namespace thalweg::controller
