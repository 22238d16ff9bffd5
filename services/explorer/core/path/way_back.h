#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "common/geometry/rigid_transform.h"
#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// The way back along that by which a robot came, to the first place on it from which it can go on. For a
/// robot to which the map shows no way out, because a passage is narrower in the map now than when the robot
/// went through it: a surface shows up to one voxel nearer than it is. The robot fits there, so its margin
/// need not. The body itself must, near to its track: what has come into the way since, such as a closed
/// door, bars it.
/// @param p_W       [m] Where the robot stands.
/// @param came      Poses on its way, newest first; between them it went straight.
/// @param radius    [m] of its body, which touches nothing on the way but what it touches at `p_W`
/// @param leads_on  Whether the robot can go on from a voxel that is traversable.
/// @return          [m] The path from `p_W`; empty if there is none.
std::vector<Eigen::Vector3d> WayBack(const PlanningMap& map, const Eigen::Vector3d& p_W,
                                     std::span<const RigidTransform> came, double radius,
                                     const std::function<bool(const VoxelIndex&)>& leads_on);

}  // namespace thalweg::explorer
