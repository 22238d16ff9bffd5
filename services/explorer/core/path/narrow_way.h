#pragma once

#include <vector>

#include "common/geometry/robot_model.h"
#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// Poses along a path, and how they begin.
struct FacedPath {
  /// The path's points and some between them; each pose's orientation is the one to have on the way to it.
  std::vector<RigidTransform> T_WBs;
  std::vector<bool> narrow;  ///< Of each pose: on the way to it the robot must be turned so.
  /// It is narrow so soon that the robot must turn to T_WBs.front() before it sets out.
  bool turn_first = false;
};

/// Faces the way that it goes wherever that is narrow, and `R_WB_end` elsewhere and at the end.
///
/// A map calls voxels free through which a surface passes when no ray has hit it there, so a surface may be
/// up to a voxel nearer than what the map shows, known or not; and where it calls voxels only weakly free
/// anything thin may stand. Where that would touch the robot, the camera must see what comes: it faces the
/// path a little ahead, or straight on beyond its end, and begins to turn to it so early that a robot at full
/// speed has done so some way before the narrow place is reached.
/// @param path_W  [m] From the robot on.
/// @param T_WB    The robot.
FacedPath FaceNarrowWays(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W,
                         const RigidTransform& T_WB, const Eigen::Matrix3d& R_WB_end,
                         const RobotModel& robot);

}  // namespace thalweg::explorer
