#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "services/explorer/core/path/coarse_map.h"
#include "services/explorer/core/strategy/strategy.h"
#include "services/explorer/core/strategy/tour.h"

namespace thalweg::explorer {

// What the tours of Flow, Cover and InspectionTour have in common.

inline constexpr double kSameStop = 0.5;  ///< [m] A stop that has moved less than this is the same stop.

/// The tour through the stops that are nearest to those of the previous one, each less than kSameStop away.
/// @param formers   The previous tour.
/// @param stops     Number of the present stops.
/// @param distance  [m] distance(former, stop)
template <class Former, class Distance>
Tour TourAsBefore(const std::vector<Former>& formers, std::size_t stops, Distance&& distance) {
  Tour tour;
  for (const Former& former : formers) {
    std::size_t nearest = stops;
    double least = kSameStop;
    for (std::size_t n = 0; n < stops; ++n) {
      const double its = distance(former, n);
      if (its >= least) continue;
      least = its;
      nearest = n;
    }
    if (nearest < stops && std::ranges::find(tour, nearest) == tour.end()) tour.push_back(nearest);
  }
  return tour;
}

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
