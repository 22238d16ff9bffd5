#pragma once

#include <algorithm>
#include <map>
#include <vector>

#include "common/voxel/grid_order.h"
#include "services/explorer/core/path/reach_changes.h"
#include "services/explorer/core/view/goal_finder.h"

namespace thalweg::explorer {

/// Finds the goals of clusters as GoalFinder does, and remembers the places of those around which nothing
/// changes.
/// Threading: one thread owns it.
class GoalMemory {
 public:
  explicit GoalMemory(const GoalFinder& finder) : finder_(finder) {}

  /// @param search  Flooded from the robot on this map.
  /// @param views   The same in all calls.
  /// @return        GoalFinder::GoalsOf each cluster.
  std::vector<std::vector<VoxelIndex>> GoalsOf(const std::vector<Cluster>& clusters, const PlanningMap& map,
                                               const PathSearch& search, const ViewPlanner& views);

  const GoalFinder& finder() const { return finder_; }
  /// For how many clusters the last call cast rays.
  std::size_t searched() const { return searched_; }

 private:
  struct Entry {
    GoalFinder::Places places;
    std::uint32_t found = 0;  ///< ReachChanges::now() by then.
  };

  struct Order {
    bool operator()(const std::vector<VoxelIndex>& a, const std::vector<VoxelIndex>& b) const {
      return std::ranges::lexicographical_compare(a, b, GridOrder{});
    }
  };
  using Entries = std::map<std::vector<VoxelIndex>, Entry, Order>;  ///< By the samples of clusters.

  GoalFinder finder_;
  ReachChanges changes_;
  Entries entries_;  ///< For the last call's clusters.
  std::size_t searched_ = 0;
};

}  // namespace thalweg::explorer
