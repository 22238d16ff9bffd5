#pragma once

#include "common/geometry/pinhole_camera.h"
#include "common/geometry/robot_model.h"
#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// [rad] What lies within that angle of where the camera looks is well inside of its image.
double AngleWellInView(const PinholeCamera& camera, const RobotModel& robot);

/// [m] The path that the robot could travel, at its usual speed, in the time of its turns to travel to a
/// place and to see a point from there, as far as they do not fit into the travel.
/// @param length  [m] To the place, along the path.
double PriceOfTurn(const VoxelIndex& place, double length, const Eigen::Vector3d& point_W,
                   const RigidTransform& T_WB, const PlanningMap& map, const PinholeCamera& camera,
                   const RobotModel& robot);

}  // namespace thalweg::explorer
