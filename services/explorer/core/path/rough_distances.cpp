#include "services/explorer/core/path/rough_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace thalweg::explorer {

RoughDistances::RoughDistances(CoarseMap& coarse, std::vector<VoxelIndex> places)
    : coarse_(coarse), places_(std::move(places)) {
  std::vector<VoxelIndex> landmarks;
  std::vector<double> to_landmark(places_.size(), std::numeric_limits<double>::infinity());
  while (landmarks.size() < std::min(kLandmarks, places_.size())) {
    const auto farthest = std::ranges::max_element(to_landmark) - to_landmark.begin();
    const VoxelIndex& landmark = landmarks.emplace_back(places_[static_cast<std::size_t>(farthest)]);
    for (std::size_t n = 0; n < places_.size(); ++n)
      to_landmark[n] = std::min(to_landmark[n], coarse_.LeastDistance(landmark, places_[n]));
  }
  from_landmarks_ = coarse_.DistancesFromEach(landmarks, places_);
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
