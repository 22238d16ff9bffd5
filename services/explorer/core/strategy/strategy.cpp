#include "services/explorer/core/strategy/strategy.h"

#include <algorithm>

namespace thalweg::explorer {

std::size_t NearestCandidate(const Situation& situation) {
  const auto nearest = std::min_element(
      situation.candidates.begin(), situation.candidates.end(),
      [](const Candidate& a, const Candidate& b) { return a.length + a.turn < b.length + b.turn; });
  return static_cast<std::size_t>(nearest - situation.candidates.begin());
}

std::vector<Eigen::Vector3d> Straightened(const Situation& situation, std::vector<Eigen::Vector3d> path_W) {
  return situation.pull_straight ? PullStraight(situation.map, path_W, situation.clearance) : path_W;
}

std::vector<Eigen::Vector3d> ShortestPath(const Situation& situation, const VoxelIndex& goal) {
  return Straightened(situation, situation.search.PathFrom(situation.map, situation.robot_W, goal));
}

Choice StraightTo(const Situation& situation, std::size_t candidate) {
  return {.candidate = candidate,
          .path_W = ShortestPath(situation, situation.candidates[candidate].goals.front())};
}

}  // namespace thalweg::explorer
