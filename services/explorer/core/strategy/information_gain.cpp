#include "services/explorer/core/strategy/information_gain.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace thalweg::explorer {

void Visit(OptionVisitor& visitor, InformationGain::Options& options) {
  visitor.Block("gain", [&](OptionVisitor& gain) {
    gain.Number("sample_share", options.sample_share);
    gain.Number("decay_per_m", options.decay);
  });
}

InformationGain::InformationGain(const Options& options, double decay) : options_(options), decay_(decay) {
  if (!(options.sample_share > 0.0 && options.sample_share <= 1.0)) {
    throw std::invalid_argument("sample_share must be in (0, 1]");
  }
  if (!(options.decay >= 0.0)) throw std::invalid_argument("decay must be >= 0");
}

bool InformationGain::Sampled(const VoxelIndex& i, double share) {
  // Finalizer of SplitMix64 [Steele, Lea, Flood: Fast splittable pseudorandom number generators, OOPSLA
  // 2014].
  std::uint64_t z = static_cast<std::uint32_t>(i.x) * 0x9E3779B97F4A7C15ULL;
  z = (z ^ static_cast<std::uint32_t>(i.y)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27) ^ static_cast<std::uint32_t>(i.z)) * 0x94D049BB133111EBULL;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) * 0x1p-53 < share;
}

Choice InformationGain::Choose(const Situation& situation) {
  const PlanningMap& map = situation.map;
  if (!gain_ || voxel_size_ != map.voxel_size()) {
    gain_.emplace(situation.views, map.voxel_size(), situation.sensor_range);
    voxel_size_ = map.voxel_size();
  }
  std::vector<VoxelIndex> targets;
  std::vector<VoxelIndex> doubtful;
  for (const Candidate& candidate : situation.candidates) {
    std::vector<VoxelIndex>& to = candidate.cluster.doubtful ? doubtful : targets;
    to.insert(to.end(), candidate.cluster.unknowns.begin(), candidate.cluster.unknowns.end());
  }
  gain_->Follow(map, targets, doubtful);

  struct Place {
    VoxelIndex voxel;
    double factor;
    double bound;  // On the score.
  };
  std::vector<Place> places;
  for (std::size_t k = 0; k < map.states().size(); ++k) {
    if (!map.Traversable(k)) continue;
    const VoxelIndex i = map.states().IndexAt(k);
    if (!Sampled(i, options_.sample_share) || !situation.search.Reached(i)) continue;
    const double factor = std::exp(-decay_ * situation.search.Length(i));
    const VoxelIndex eye = map.EyeOf(i);
    if (map.State(eye) != VoxelState::kFree) continue;
    const double bound = factor * gain_->UpperBound(eye);
    if (bound > 0.0) places.push_back({i, factor, bound});
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.bound > b.bound; });
  SensorGain::Gain best;
  VoxelIndex best_place;
  double best_score = 0.0;
  for (const Place& place : places) {
    if (place.bound < best_score) break;
    SensorGain::Gain gain = gain_->BestView(map.EyeOf(place.voxel));
    const double score = place.factor * gain.value;
    const bool nearer = score == best_score && score > 0.0 &&
                        situation.search.Cost(place.voxel) < situation.search.Cost(best_place);
    if (score <= best_score && !nearer) continue;
    best = std::move(gain);
    best_place = place.voxel;
    best_score = score;
  }
  if (best.seen.empty()) return StraightTo(situation, NearestCandidate(situation));

  // Several clusters may be visible from there; the choice names the one of which most is visible.
  Choice choice{.candidate = 0, .path_W = ShortestPath(situation, best_place), .target = best.seen};
  std::size_t most = 0;
  for (std::size_t n = 0; n < situation.candidates.size(); ++n) {
    const std::vector<VoxelIndex>& unknowns = situation.candidates[n].cluster.unknowns;
    const auto seen =
        static_cast<std::size_t>(std::count_if(best.seen.begin(), best.seen.end(), [&](const VoxelIndex& i) {
          return std::find(unknowns.begin(), unknowns.end(), i) != unknowns.end();
        }));
    if (seen > most) {
      most = seen;
      choice.candidate = n;
    }
  }
  return choice;
}

}  // namespace thalweg::explorer
