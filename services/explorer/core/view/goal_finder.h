#pragma once

#include <vector>

#include "services/explorer/core/map/frontier.h"
#include "services/explorer/core/path/path_search.h"
#include "services/explorer/core/view/view.h"

namespace thalweg::explorer {

/// Finds places from which a cluster is in plain sight, the nearest to the cluster that the robot can reach.
///
/// Rays go outwards from some of the cluster's unknowns through free space; the first voxel of each in which
/// the camera of a robot in reach can be is one from which that unknown is seen.
/// Threading: any number of threads may ask.
class GoalFinder {
 public:
  /// @param look_range  [m] No further from the cluster than that.
  GoalFinder(double look_range, double voxel_size);

  /// @param search  Flooded from the robot.
  /// @return Each place once, the nearest to the robot first; none when nothing in reach sees the cluster.
  std::vector<VoxelIndex> GoalsOf(const Cluster& cluster, const PlanningMap& map, const PathSearch& search,
                                  const ViewPlanner& views) const;

 private:
  std::vector<std::vector<RayStep>> rays_;
  int reach_;  ///< [voxels] None goes further on any axis.
};

}  // namespace thalweg::explorer
