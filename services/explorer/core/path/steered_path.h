#pragma once

#include <optional>
#include <vector>

#include "common/base/angles.h"
#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// A robot that turns only in curves, and drives forward and back.
struct SteeringModel {
  double min_turning_radius = 0.0;  ///< [m] > 0; tighter curves it cannot drive.
  double body_radius = 0.0;         ///< [m] Without margin.
  /// [m] How far from where it stands, if it is not clear there, it may drive through free voxels in which it
  /// is not, as long as it touches nothing occupied that it does not touch already
  /// (PlanningMap::ClearToLeave); as PathSearch::Exemption.
  double exemption = 0.0;
  /// [m] The same where there is no other path. If it is clear where it stands and comes no farther than
  /// this, it may go so far with less of its margin, then with none, and at last like one that is not clear.
  double wide_exemption = 0.0;
};

/// Where a path is to end: not farther than `distance` from a point, and turned away by no more than `angle`.
struct SteeringGoal {
  Eigen::Vector3d p_W;             ///< [m]
  std::optional<double> yaw = {};  ///< [rad] Heading in W; empty = any.
  double distance = 0.1;           ///< [m]
  double angle = 10.0 * kDegree;   ///< [rad]
  /// The robot has stood there, so that within the exemption it need not be clear.
  bool was_there = false;
};

/// A path through traversable space that such a robot can drive: straight lines and arcs of its tightest
/// curve, but a tenth wider, so that a controller can steer back, or three times as wide, forward and back.
/// Found by A* over voxels and headings, where each state keeps the exact pose in which it was reached first
/// [Dolgov, Thrun, Montemerlo, Diebel, Path Planning for Autonomous Vehicles in Unknown Semi-structured
/// Environments, IJRR 29(5), 2010]. The rest of the way is estimated as the greater of the shortest path for
/// a robot that turns anywhere, and of the arc by which the heading has yet to turn; it weighs 1.7 times as
/// much as the way so far, so that paths may be longer than the shortest, and are found in large rooms, too.
/// Driving back costs twice as much as forward, since the camera does not see what comes, and changing over
/// as much as 0.3 m.
/// @param map   With a plane.
/// @param T_WB  Pose of the robot, in the plane.
/// @return      Poses from the robot's on; the robot drives back to those that lie behind the one before.
///              Empty when there is none, or none was found among the first 400 000 states.
std::optional<std::vector<RigidTransform>> SteerTo(const PlanningMap& map, const RigidTransform& T_WB,
                                                   const SteeringGoal& goal, const SteeringModel& model);

}  // namespace thalweg::explorer
