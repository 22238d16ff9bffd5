#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/rigid_transform.h"
#include "services/explorer/core/map/planning_map.h"
#include "services/explorer/core/path/path_search.h"

namespace thalweg::explorer {

/// Places half a voxel apart on the way by which a robot came, from where it stands back to the beginning.
/// @param p_W   [m] Where it stands.
/// @param came  Poses on its way, newest first; between them it went straight.
/// @return      [m] In the map's plane, if it has one.
std::vector<Eigen::Vector3d> TrackBack(const PlanningMap& map, const Eigen::Vector3d& p_W,
                                       std::span<const RigidTransform> came);

/// Where the way by which a robot came is shut.
struct ShutTrack {
  std::vector<Eigen::Vector3d> path_W;  ///< [m] To the earliest place on its track that a path leads to.
  Eigen::Vector3d beyond_W;             ///< [m] On its track, a little further back.
};
/// Nothing if the robot does not fit where it stands, or a path leads to where its track begins.
std::optional<ShutTrack> FindShut(const PlanningMap& map, const std::vector<Eigen::Vector3d>& track_W);

/// The part of the space in which a robot fits that is at least half of it, flooded from the newest place of
/// its track that lies in it; nothing if none does.
std::optional<PathSearch> MostOfSpaceOn(const std::vector<Eigen::Vector3d>& track_W, const PlanningMap& map);

/// The way back along a robot's track to the first place from which it can go on. For a robot to which the
/// map shows no way out, because a passage is narrower in the map now than when the robot went through it: a
/// surface shows up to one voxel nearer than it is. The robot fits there, so its margin need not. The body
/// itself must, on its track or as little beside it as can be, at most half a voxel, and touches nothing but
/// what it touches where it stands: what has come into the way since, such as a closed door, bars it.
/// @param track_W   [m] See TrackBack.
/// @param radius    [m] of its body, without margin
/// @param leads_on  Whether the robot can go on from a voxel that is traversable.
/// @return          [m] The path from where it stands; empty if there is none.
std::vector<Eigen::Vector3d> WayBack(const PlanningMap& map, const std::vector<Eigen::Vector3d>& track_W,
                                     double radius, const std::function<bool(const VoxelIndex&)>& leads_on);

}  // namespace thalweg::explorer
