#include "services/explorer/core/strategy.h"

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <utility>

#include "services/explorer/core/potential.h"

namespace thalweg::explorer {
namespace {

/// The cluster at the end of the shortest path [Yamauchi 1997].
class Closest final : public Strategy {
 public:
  Choice Choose(const Situation& situation) override {
    const auto nearest =
        std::min_element(situation.candidates.begin(), situation.candidates.end(),
                         [](const Candidate& a, const Candidate& b) { return a.length < b.length; });
    return {.candidate = static_cast<std::size_t>(nearest - situation.candidates.begin()),
            .path_W = ShortestPath(situation, *nearest)};
  }
};

using Maker = std::function<std::unique_ptr<Strategy>(const StrategyOptions&)>;

const std::vector<std::pair<std::string_view, Maker>>& Makers() {
  static const std::vector<std::pair<std::string_view, Maker>> makers = {
      {"closest", [](const StrategyOptions&) { return std::make_unique<Closest>(); }},
      {"potential", [](const StrategyOptions& options) { return std::make_unique<Potential>(options); }},
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

std::vector<Eigen::Vector3d> ShortestPath(const Situation& situation, const Candidate& candidate) {
  std::vector<Eigen::Vector3d> path_W = {situation.robot_W};
  for (const VoxelIndex& voxel : situation.search.PathTo(candidate.goals.front())) {
    path_W.push_back(situation.map.CenterOf(voxel));
  }
  return PullStraight(situation.map, path_W, situation.clearance);
}

}  // namespace thalweg::explorer
