#include "services/explorer/core/candidate_search.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "common/base/stopwatch.h"
#include "services/explorer/core/path/shut_in.h"

namespace thalweg::explorer {
namespace {

/// The unknown space that connects, across faces and within the bounds, with frontier voxels that were looked
/// at in vain or are not set aside: too few to matter, or not worth their path.
std::vector<VoxelChange> AsIfFree(const PlanningMap& map, const DenseGrid<std::uint8_t>& set_aside) {
  DenseGrid<std::uint8_t> taken(map.box(), 0);
  std::vector<VoxelIndex> space;
  const auto take = [&](const VoxelIndex& i) {
    if (!taken.Contains(i) || taken[i] != 0 || map.State(i) != VoxelState::kUnknown || !map.InBounds(i))
      return;
    taken[i] = 1;
    space.push_back(i);
  };
  for (std::size_t k = 0; k < set_aside.size(); ++k) {
    const VoxelIndex i = set_aside.IndexAt(k);
    if (set_aside[i] == 0 ? IsTarget(map, i) : IsInVain(static_cast<AsideReason>(set_aside[i]))) take(i);
  }
  for (std::size_t n = 0; n < space.size(); ++n) {
    const VoxelIndex at = space[n];
    for (const VoxelIndex& step : kFaceNeighbors) take(at + step);
  }
  std::vector<VoxelChange> changes;
  changes.reserve(space.size());
  for (const VoxelIndex& i : space) changes.push_back({i, kSurelyFree});
  return changes;
}

}  // namespace

CandidateSearch::CandidateSearch(const Options& options)
    : options_(options), goal_finder_(options.look_range, options.voxel_size) {
  if (!(options.frontier.min_area >= 0.0)) throw std::invalid_argument("min_cluster_area must be >= 0");
  if (!(options.frontier.extent > 0.0)) throw std::invalid_argument("cluster_extent must be > 0");
}

void CandidateSearch::Find(const Eigen::Vector3d& p_W, const Mission& mission, Time now, Knowledge& knowledge,
                           StageTimings& timings) {
  FindFrom(p_W, {options_.exemption}, mission, now, knowledge, timings);
  if (candidates_.empty() && IsShutIn(knowledge.map(), search_)) {
    knowledge.memory().Release(AsideReason::kOutOfSight);  // what the narrow search has set aside
    FindFrom(p_W, {options_.wide_exemption, true}, mission, now, knowledge, timings);
  }
  if (candidates_.empty()) FindOutOfSight(p_W, mission, now, knowledge, timings);
}

bool CandidateSearch::FindOutOfSight(const Eigen::Vector3d& p_W, const Mission& mission, Time now,
                                     Knowledge& knowledge, StageTimings& timings) {
  const std::size_t before = knowledge.memory().Release(AsideReason::kOutOfSight);
  if (before == 0) return false;
  FindFrom(p_W, exemption_, mission, now, knowledge, timings);
  return knowledge.memory().Count(AsideReason::kOutOfSight) < before;
}

void CandidateSearch::FindSmallest(const Eigen::Vector3d& p_W, const Mission& mission, Time now,
                                   Knowledge& knowledge, StageTimings& timings) {
  const double usual = std::exchange(options_.frontier.min_area, 0.0);
  FindFrom(p_W, exemption_, mission, now, knowledge, timings);
  options_.frontier.min_area = usual;
}

void CandidateSearch::FindFrom(const Eigen::Vector3d& p_W, const PathSearch::Exemption& exemption,
                               const Mission& mission, Time now, Knowledge& knowledge,
                               StageTimings& timings) {
  exemption_ = exemption;
  const std::vector<PathSearch::Start> parts = PathSearch::Parts(
      knowledge.map(), PathSearch::StartAt(knowledge.map(), p_W, options_.robot_radius, exemption));
  FindFromPart(parts.front(), exemption.from_pocket, mission, now, knowledge, timings);
  for (std::size_t n = 1; n < parts.size() && candidates_.empty(); ++n) {
    knowledge.memory().Release(AsideReason::kOutOfSight);  // what the previous part has set aside
    FindFromPart(parts[n], true, mission, now, knowledge, timings);
  }
  // Statements about the reachable space at an ending refer to the largest part.
  if (parts.size() > 1 && candidates_.empty()) search_.Flood(knowledge.map(), parts.front());
}

void CandidateSearch::FindFromPart(const PathSearch::Start& start, bool must_know_return,
                                   const Mission& mission, Time now, Knowledge& knowledge,
                                   StageTimings& timings) {
  const PlanningMap& map = knowledge.map();
  candidates_.clear();
  const Stopwatch flood;
  search_.Flood(map, start);
  timings["flood"].Add(flood.Milliseconds());
  const Stopwatch finding;
  frontiers_ = FindFrontiers(map, knowledge.memory().set_aside(), options_.frontier);
  timings["frontiers"].Add(finding.Milliseconds());
  const Stopwatch goals_watch;
  for (const Cluster& cluster : frontiers_.clusters) {
    std::vector<VoxelIndex> goals = goal_finder_.GoalsOf(cluster, map, search_, knowledge.views());
    if (must_know_return && mission.returns_home()) {
      std::erase_if(goals, [&](const VoxelIndex& goal) {
        return !mission.home_paths().LengthFrom(map, map.CenterOf(goal));
      });
    }
    if (goals.empty()) {
      for (const VoxelIndex& i : cluster.unknowns)
        knowledge.memory().SetAside(i, AsideReason::kOutOfSight, now);
      continue;
    }
    const double length = search_.Length(goals.front());
    candidates_.push_back({cluster, std::move(goals), length});
  }
  timings["goals"].Add(goals_watch.Milliseconds());
}

CandidateSearch::Hidden CandidateSearch::FindHidden(const Knowledge& knowledge) const {
  const DenseGrid<std::uint8_t>& set_aside = knowledge.memory().set_aside();
  const std::vector<VoxelChange> changes = AsIfFree(knowledge.map(), set_aside);
  if (changes.empty()) return {};
  DenseGrid<std::uint8_t> all_but_out_of_sight(set_aside.box(), 0);
  for (std::size_t k = 0; k < set_aside.size(); ++k) {
    const VoxelIndex i = set_aside.IndexAt(k);
    const bool out_of_sight = set_aside[i] == static_cast<std::uint8_t>(AsideReason::kOutOfSight);
    all_but_out_of_sight[i] = out_of_sight ? 0 : 1;
  }
  const FrontierOptions every{.min_area = 0.0, .extent = options_.frontier.extent};
  const Frontiers out_of_sight = FindFrontiers(knowledge.map(), all_but_out_of_sight, every);
  PlanningMap map = knowledge.map();
  map.Apply(changes);
  PathSearch search;
  search.Flood(map, search_.start());
  Hidden hidden;
  for (const Cluster& cluster : out_of_sight.clusters) {
    if (cluster.doubtful) continue;
    const std::vector<VoxelIndex> goals = goal_finder_.GoalsOf(cluster, map, search, knowledge.views());
    if (goals.empty()) continue;
    hidden.voxels += cluster.unknowns.size();
    const std::vector<VoxelIndex> path = search.PathTo(goals.front());
    const auto bar = std::ranges::find_if(path, [&](const VoxelIndex& i) { return !search_.Reached(i); });
    if (bar != path.end() && std::ranges::find(hidden.bars, *bar) == hidden.bars.end())
      hidden.bars.push_back(*bar);
  }
  return hidden;
}

void CandidateSearch::Take(std::vector<Candidate> candidates) {
  frontiers_ = {};
  candidates_ = std::move(candidates);
}

std::optional<Budget> CandidateSearch::DropTooFar(const PlanningMap& map, const Mission& mission, Time now) {
  std::optional<Budget> too_far;
  std::erase_if(candidates_, [&](const Candidate& candidate) {
    const auto budget = mission.TooFar(map, candidate.length, map.CenterOf(candidate.goals.front()), now);
    if (budget) too_far = budget;
    return budget.has_value();
  });
  return too_far;
}

}  // namespace thalweg::explorer
