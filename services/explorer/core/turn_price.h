#pragma once

#include "common/geometry/pinhole_camera.h"
#include "common/geometry/robot_model.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// [rad] What lies within that angle of where the camera looks is well inside of its image.
double AngleWellInView(const PinholeCamera& camera, const RobotModel& robot);

/// [m] As Candidate::turn: the path that the robot could travel, at its usual speed, in the time of its turns
/// to travel to a candidate and to see it, as far as they do not fit into the travel.
double PriceOfTurn(const Candidate& candidate, const RigidTransform& T_WB, const PlanningMap& map,
                   const PinholeCamera& camera, const RobotModel& robot);

}  // namespace thalweg::explorer
