#pragma once

#include <vector>

#include "common/base/angles.h"
#include "common/geometry/robot_model.h"
#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// Poses along a path, and whether to turn before setting out.
struct FacedPath {
  /// The vertices of the path and some points in between. Each orientation applies to the segment that leads
  /// to its pose.
  std::vector<RigidTransform> T_WBs;
  /// For each pose: whether the robot must have its orientation on the segment that leads to it.
  std::vector<bool> narrow;
  /// The passage is so near that the robot must turn to T_WBs.front() before it sets out.
  bool turn_first = false;
};

/// The camera of any robot sees the path although it is turned away from it by that much; poses are no finer.
inline constexpr double kOffThePath = 15.0 * kDegree;  // [rad]

/// Whether what the map does not show could touch a body there: a surface up to one voxel nearer than the
/// map's, or something thin where space is only weakly free.
bool IsNarrow(const PlanningMap& map, const Eigen::Vector3d& p_W, const RobotModel& robot);

/// Faces the direction of travel in narrow passages, and `R_WB_end` elsewhere and at the end.
///
/// A map marks a voxel free although a surface passes through it when no ray has hit the surface there, so a
/// surface may be up to one voxel nearer than the map shows. Where voxels are only weakly free, something
/// thin may stand. Wherever that could touch the robot, the camera must see what comes: it faces the path a
/// little ahead, or its straight extension beyond the end, and starts to turn so early that a robot at full
/// speed has finished the turn before it reaches the passage. A level body only turns its heading there, so
/// its camera does not see what comes where it rises or sinks steeply.
/// @param path_W  [m] Starts at the robot.
/// @param T_WB    Pose of the robot.
/// @param sees    [rad] The camera sees the path although it is turned away from it by that much, so a robot
/// that
///                is need not turn before it sets out.
FacedPath FaceNarrowPassages(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W,
                             const RigidTransform& T_WB, const Eigen::Matrix3d& R_WB_end,
                             const RobotModel& robot, double sees = kOffThePath);

/// Faces the direction of travel everywhere: along each segment of the path. A vertical segment keeps the
/// heading.
FacedPath FaceTravel(const std::vector<Eigen::Vector3d>& path_W, const RigidTransform& T_WB);

/// The same, then turns to `R_WB_end` where the path ends.
FacedPath FaceTravelThenTurn(const std::vector<Eigen::Vector3d>& path_W, const RigidTransform& T_WB,
                             const Eigen::Matrix3d& R_WB_end);

}  // namespace thalweg::explorer
