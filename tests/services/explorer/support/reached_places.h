#pragma once

#include <random>
#include <vector>

#include "services/explorer/core/path/path_search.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer::test {

/// Floods from a random voxel from which at least half of the traversable ones are reached, and returns
/// random reached voxels.
inline std::vector<VoxelIndex> ReachedPlaces(const PlanningMap& map, std::size_t count, std::mt19937& random,
                                             PathSearch& search) {
  const std::vector<VoxelIndex> traversable = TraversableVoxels(map);
  do {
    search.Flood(map, {{traversable[random() % traversable.size()], 0}});
  } while (2 * search.reached_count() < traversable.size());
  std::vector<VoxelIndex> places;
  while (places.size() < count) {
    const VoxelIndex& place = traversable[random() % traversable.size()];
    if (search.Reached(place)) places.push_back(place);
  }
  return places;
}

}  // namespace thalweg::explorer::test
