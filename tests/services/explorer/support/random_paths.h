#pragma once

#include <random>
#include <vector>

#include "services/explorer/core/path/path_search.h"

namespace thalweg::explorer::test {

/// A straightened path [m] between two of the traversable voxels, chosen at random; empty when none connects
/// them.
inline std::vector<Eigen::Vector3d> RandomPath(std::mt19937& random, const PlanningMap& map,
                                               const std::vector<VoxelIndex>& traversable) {
  const VoxelIndex& from = traversable[random() % traversable.size()];
  const VoxelIndex& to = traversable[random() % traversable.size()];
  const auto voxels = PathSearch::FindPath(map, {{from, 0}}, to);
  std::vector<Eigen::Vector3d> path_W;
  if (!voxels) return path_W;
  for (const VoxelIndex& i : *voxels) path_W.push_back(map.CenterOf(i));
  return PullStraight(map, path_W, map.options().clearance);
}

}  // namespace thalweg::explorer::test
