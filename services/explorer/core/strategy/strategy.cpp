#include "services/explorer/core/strategy/strategy.h"

#include <algorithm>
#include <functional>
#include <random>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "services/explorer/core/strategy/flow.h"
#include "services/explorer/core/strategy/information_gain.h"
#include "services/explorer/core/strategy/potential.h"
#include "services/explorer/core/strategy/size_bonus.h"

namespace thalweg::explorer {
namespace {

/// The cluster at the end of the shortest path [Yamauchi 1997].
class Closest final : public Strategy {
 public:
  Choice Choose(const Situation& situation) override {
    Choice choice = StraightTo(situation, NearestCandidate(situation));
    for (const Candidate& candidate : situation.candidates) choice.scores.push_back(-candidate.length);
    return choice;
  }
};

/// A random one of all unknown voxels that could be seen: the baseline of baselines.
class Random final : public Strategy {
 public:
  explicit Random(std::uint32_t seed) : random_(seed) {}
  Choice Choose(const Situation& situation) override {
    std::size_t voxels = 0;
    for (const Candidate& candidate : situation.candidates) voxels += candidate.cluster.unknowns.size();
    std::size_t drawn = random_() % std::max<std::size_t>(1, voxels);
    std::size_t n = 0;
    for (; drawn >= situation.candidates[n].cluster.unknowns.size() && n + 1 < situation.candidates.size();
         ++n) {
      drawn -= situation.candidates[n].cluster.unknowns.size();
    }
    return StraightTo(situation, n);
  }

 private:
  std::mt19937 random_;  // whose numbers the standard fixes
};

using Maker = std::function<std::unique_ptr<Strategy>(const StrategyOptions&)>;

const std::vector<std::pair<std::string_view, Maker>>& Makers() {
  static const std::vector<std::pair<std::string_view, Maker>> makers = {
      {"closest", [](const StrategyOptions&) { return std::make_unique<Closest>(); }},
      {"random", [](const StrategyOptions& o) { return std::make_unique<Random>(o.seed); }},
      {"information_gain",
       [](const StrategyOptions& o) { return std::make_unique<InformationGain>(o.gain, 0.0); }},
      {"weighted_information_gain",
       [](const StrategyOptions& o) { return std::make_unique<InformationGain>(o.gain, o.gain.decay); }},
      {"potential", [](const StrategyOptions& o) { return std::make_unique<Potential>(o.potential); }},
      {"potential_flux",
       [](const StrategyOptions&) { return std::make_unique<Potential>(FluxPerLengthOptions()); }},
      {"flow", [](const StrategyOptions& o) { return std::make_unique<Flow>(o.flow); }},
      {"size_bonus", [](const StrategyOptions&) { return std::make_unique<SizeBonus>(); }},
  };
  return makers;
}

}  // namespace

std::unique_ptr<Strategy> MakeStrategy(const StrategyOptions& options) {
  std::string names;
  for (const auto& [name, make] : Makers()) {
    if (name == options.name) return make(options);
    names += (names.empty() ? "" : ", ") + std::string(name);
  }
  throw std::invalid_argument("strategy '" + options.name + "' is unknown; there are: " + names);
}

std::size_t NearestCandidate(const Situation& situation) {
  const auto nearest =
      std::min_element(situation.candidates.begin(), situation.candidates.end(),
                       [](const Candidate& a, const Candidate& b) { return a.length < b.length; });
  return static_cast<std::size_t>(nearest - situation.candidates.begin());
}

std::vector<Eigen::Vector3d> ShortestPath(const Situation& situation, const VoxelIndex& goal) {
  std::vector<Eigen::Vector3d> path_W = {situation.robot_W};
  for (const VoxelIndex& voxel : situation.search.PathTo(goal)) {
    path_W.push_back(situation.map.CenterOf(voxel));
  }
  return PullStraight(situation.map, path_W, situation.clearance);
}

Choice StraightTo(const Situation& situation, std::size_t candidate) {
  return {.candidate = candidate,
          .path_W = ShortestPath(situation, situation.candidates[candidate].goals.front())};
}

}  // namespace thalweg::explorer
