#pragma once

#include <algorithm>

#include "common/geometry/robot_model.h"

namespace thalweg::controller {

/// [s] In which the robot comes to stand from its greatest speed and turn rate, at its accelerations and
/// unlimited jerk.
inline double BrakingTime(const RobotModel& robot) {
  return std::max(robot.max_speed / robot.max_acceleration,
                  robot.greatest_turn_rate() / robot.max_turn_acceleration);
}

}  // namespace thalweg::controller
