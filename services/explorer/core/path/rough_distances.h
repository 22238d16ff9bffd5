#pragma once

#include <cstddef>
#include <vector>

#include "services/explorer/core/path/coarse_map.h"

namespace thalweg::explorer {

/// Path lengths between many places: those of up to kNear as CoarseMap computes them, and longer ones as the
/// shortest path by way of one of a few landmarks, which is too long by about twice the path from either end
/// to the nearest landmark at most. Only the landmarks need floods of the whole map. Landmarks are places,
/// each the farthest from those before it: by CoarseMap::LeastDistance from those whose floods are made at
/// the same time, by path from others [Gonzalez: Clustering to minimize the maximum intercluster distance,
/// Theoretical Computer Science 38, 1985; Goldberg, Harrelson: Computing the shortest path: A* search meets
/// graph theory, SODA 2005].
/// Threading: one thread.
class RoughDistances {
 public:
  static constexpr double kNear = 3.0;  ///< [m]
  static constexpr std::size_t kLandmarks = 16;

  /// Keeps a reference to the map. @param places  Reached.
  RoughDistances(CoarseMap& coarse, std::vector<VoxelIndex> places);

  /// [m] From one of the places to each.
  std::vector<double> From(std::size_t place);

 private:
  CoarseMap& coarse_;
  std::vector<VoxelIndex> places_;
  std::vector<std::vector<double>> from_landmarks_;  ///< [m] From each to all places.
};

}  // namespace thalweg::explorer
