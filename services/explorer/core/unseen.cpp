#include "services/explorer/core/unseen.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace thalweg::explorer {
namespace {

DenseGrid<std::uint8_t> AllButUnseen(const DenseGrid<std::uint8_t>& set_aside) {
  DenseGrid<std::uint8_t> mask(set_aside.box(), 0);
  for (std::size_t k = 0; k < set_aside.size(); ++k) {
    const VoxelIndex i = set_aside.IndexAt(k);
    mask[i] = set_aside[i] == static_cast<std::uint8_t>(AsideReason::kOutOfSight) ? 0 : 1;
  }
  return mask;
}

}  // namespace

std::vector<Unseen> FindUnseen(const PlanningMap& other, const Knowledge& knowledge, const PathSearch& search,
                               const GoalFinder& goals, double extent) {
  const FrontierOptions every{.min_area = 0.0, .extent = extent};
  Frontiers frontiers = FindFrontiers(knowledge.map(), AllButUnseen(knowledge.memory().set_aside()), every);
  PathSearch::Start reached;
  for (std::size_t k = 0; k < search.costs().size(); ++k) {
    if (search.costs()[k] != PathSearch::kUnreached) reached.push_back({search.costs().IndexAt(k), 0});
  }
  PathSearch there;
  there.Flood(other, reached);
  std::vector<Unseen> found;
  for (Cluster& cluster : frontiers.clusters) {
    if (cluster.doubtful) continue;
    const std::vector<VoxelIndex> places = goals.GoalsOf(cluster, other, there, knowledge.views());
    if (!places.empty()) found.push_back({std::move(cluster), there.PathTo(places.front())});
  }
  std::ranges::stable_sort(found, {}, [&](const Unseen& unseen) { return there.Cost(unseen.path.back()); });
  return found;
}

}  // namespace thalweg::explorer
