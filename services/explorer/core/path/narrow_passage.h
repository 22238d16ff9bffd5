#pragma once

#include <vector>

#include "common/geometry/robot_model.h"
#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// Poses along a path, and how to set out.
struct FacedPath {
  /// The path's points and some between them; each pose's orientation is the one to have on the way to it.
  std::vector<RigidTransform> T_WBs;
  std::vector<bool> narrow;  ///< For each pose: the robot must have its orientation on the way to it.
  /// The passage is so near that the robot must turn to T_WBs.front() before it sets out.
  bool turn_first = false;
};

/// Faces the direction of travel in narrow passages, and `R_WB_end` elsewhere and at the end.
///
/// A map calls a voxel free although a surface passes through it when no ray has hit the surface there, so a
/// surface may be up to a voxel nearer than the map shows; and where voxels are only weakly free something
/// thin may stand. Where that could touch the robot, the camera must see what comes: it faces the path a
/// little ahead, or straight on beyond its end, and begins to turn so early that a robot at full speed has
/// finished before it reaches the passage.
/// @param path_W  [m] From the robot on.
/// @param T_WB    The robot.
FacedPath FaceNarrowPassages(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W,
                             const RigidTransform& T_WB, const Eigen::Matrix3d& R_WB_end,
                             const RobotModel& robot);

}  // namespace thalweg::explorer
