#include "services/explorer/core/path/rough_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace thalweg::explorer {
namespace {

constexpr std::size_t kBatch = 4;  // [landmarks] Found at once, on as many cores.

}  // namespace

RoughDistances::RoughDistances(CoarseMap& coarse, std::vector<VoxelIndex> places)
    : coarse_(coarse), places_(std::move(places)) {
  std::vector<double> to_landmark(places_.size(), std::numeric_limits<double>::infinity());
  const auto bring_nearer = [&](const auto& distance) {
    for (std::size_t n = 0; n < places_.size(); ++n) to_landmark[n] = std::min(to_landmark[n], distance(n));
  };
  const std::size_t count = std::min(kLandmarks, places_.size());
  while (from_landmarks_.size() < count) {
    std::vector<VoxelIndex> batch;
    const std::vector<double> before = to_landmark;
    while (batch.size() < std::min(kBatch, count - from_landmarks_.size())) {
      const auto farthest = std::ranges::max_element(to_landmark) - to_landmark.begin();
      const VoxelIndex& landmark = batch.emplace_back(places_[static_cast<std::size_t>(farthest)]);
      bring_nearer([&](std::size_t n) { return coarse_.LeastDistance(landmark, places_[n]); });
    }
    to_landmark = before;
    for (std::vector<double>& from : coarse_.DistancesFromEach(batch, places_)) {
      bring_nearer([&](std::size_t n) { return from[n]; });
      from_landmarks_.push_back(std::move(from));
    }
  }
}

std::vector<double> RoughDistances::From(std::size_t place) {
  std::vector<double> lengths = coarse_.DistancesFrom(places_[place], places_, kNear);
  std::vector<double> over_landmark(places_.size(), std::numeric_limits<double>::infinity());
  for (const std::vector<double>& from : from_landmarks_) {
    const double first = from[place];
    for (std::size_t n = 0; n < places_.size(); ++n)
      over_landmark[n] = std::min(over_landmark[n], first + from[n]);
  }
  for (std::size_t n = 0; n < places_.size(); ++n) {
    if (std::isinf(lengths[n])) lengths[n] = over_landmark[n];
  }
  return lengths;
}

}  // namespace thalweg::explorer
