#pragma once

#include <vector>

#include "services/explorer/core/map/frontier.h"
#include "services/explorer/core/path/path_search.h"
#include "services/explorer/core/view/view.h"

namespace thalweg::explorer {

/// Finds reachable positions with a clear line of sight to a cluster, as near to the cluster as possible.
///
/// Rays are cast outward through free space from some of the cluster's unknown voxels. The first voxel on
/// each ray that can hold the camera of a robot in a reachable position gives a position from which that
/// unknown voxel is seen.
/// Threading: may be called from any number of threads.
class GoalFinder {
 public:
  /// @param look_range  [m] Largest distance from the cluster.
  GoalFinder(double look_range, double voxel_size);

  /// @param search  Flooded from the robot.
  /// @return Each position once, nearest to the robot first; empty when no reachable position sees the
  /// cluster.
  std::vector<VoxelIndex> GoalsOf(const Cluster& cluster, const PlanningMap& map, const PathSearch& search,
                                  const ViewPlanner& views) const {
    return NearestFirst(PlacesOf(SampleOf(cluster), map, search, views), search);
  }

  // What GoalsOf consists of.

  /// The voxels of a cluster that its goals are found for.
  static std::vector<VoxelIndex> SampleOf(const Cluster& cluster);
  /// The goals in no order.
  struct Places {
    std::vector<VoxelIndex> voxels;
    VoxelBox depends_on;  ///< They depend on what is in this box alone: its states and what is reached there.
  };
  Places PlacesOf(const std::vector<VoxelIndex>& sample, const PlanningMap& map, const PathSearch& search,
                  const ViewPlanner& views) const;
  static std::vector<VoxelIndex> NearestFirst(const Places& places, const PathSearch& search);

 private:
  std::vector<std::vector<RayStep>> rays_;
  int reach_;  ///< [voxels] Largest offset of a ray on any axis.
};

}  // namespace thalweg::explorer
