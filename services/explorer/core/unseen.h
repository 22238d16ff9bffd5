#pragma once

#include <optional>
#include <vector>

#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/map/frontier.h"
#include "services/explorer/core/path/path_search.h"
#include "services/explorer/core/view/goal_finder.h"

namespace thalweg::explorer {

/// A cluster that is set aside as out of sight, and would be seen if the map were another.
struct Unseen {
  Cluster cluster;
  /// The shortest path on the other map from what the robot can reach to a place that sees the cluster,
  /// including both ends; a single voxel if the robot can reach the place.
  std::vector<VoxelIndex> path;

  /// Where the path leaves what the robot can reach; empty if it does not.
  std::optional<VoxelIndex> Bar() const { return path.size() > 1 ? std::optional(path[1]) : std::nullopt; }
};

/// Those with the shortest paths first. O(voxels of the map's box).
/// @param other   A map of the same box; says where the robot could be, and through what it could look.
/// @param search  Flooded from the robot on the present map.
/// @param extent  [m] See FrontierOptions.
std::vector<Unseen> FindUnseen(const PlanningMap& other, const Knowledge& knowledge, const PathSearch& search,
                               const GoalFinder& goals, double extent);

}  // namespace thalweg::explorer
