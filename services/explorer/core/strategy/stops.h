#pragma once

#include <cmath>
#include <vector>

#include "services/explorer/core/path/coarse_map.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

// What the strategies that plan tours, Flow and Cover, have in common.

inline constexpr double kSameStop = 0.5;  ///< [m] A stop that has moved less than this is the same stop.

/// [voxels]
inline double WeightOf(const Cluster& cluster) {
  return cluster.weight * static_cast<double>(cluster.unknowns.size());
}

/// [voxels] For each candidate, the worth of the unknown region behind it.
inline std::vector<double> WorthBehind(const Situation& situation, const CoarseMap& coarse) {
  /// [m^3] A dark region of this volume counts half. Much smaller regions are the insides of objects.
  constexpr double kHollowVolume = 5.0;
  const std::vector<VoxelIndex> nothing;  // Doubtful clusters have no unknown region behind them.
  std::vector<const std::vector<VoxelIndex>*> groups;
  for (const Candidate& candidate : situation.candidates)
    groups.push_back(candidate.cluster.doubtful ? &nothing : &candidate.cluster.unknowns);
  const double hollow = kHollowVolume / std::pow(situation.map.voxel_size(), 3);
  return coarse.WorthBehind(groups, [hollow](double volume) { return volume * volume / (volume + hollow); });
}

}  // namespace thalweg::explorer
