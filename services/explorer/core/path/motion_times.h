#pragma once

#include "common/geometry/robot_model.h"

namespace thalweg::explorer {

// How long a robot takes to move and to turn, for prices.

/// [s] For a straight path [m] from rest to rest.
double TravelTime(double length, const RobotModel& robot);
/// [s] For a turn [rad] from rest to rest; the rate rises and falls at its greatest acceleration. One that
/// cannot turn on the spot drives along its tightest curve.
double TurnTime(double angle, const RobotModel& robot);
/// [s] For a turn between two orientations that it can have, from rest to rest.
double TurnTime(const Eigen::Matrix3d& R_WB_from, const Eigen::Matrix3d& R_WB_to, const RobotModel& robot);
/// [m] The path that a robot travels in a time [s] at its usual speed, half of its greatest.
double UsualPath(double time, const RobotModel& robot);

}  // namespace thalweg::explorer
