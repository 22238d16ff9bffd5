#include "services/explorer/core/candidate_search.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "common/base/stopwatch.h"
#include "services/explorer/core/path/shut_in.h"
#include "services/explorer/core/unseen.h"

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
    : options_(options), goals_(GoalFinder(options.look_range, options.voxel_size)) {
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
  const std::vector<Cluster>& clusters = frontiers_.clusters;
  std::vector<std::vector<VoxelIndex>> goals_of = goals_.GoalsOf(clusters, map, search_, knowledge.views());
  for (std::size_t n = 0; n < clusters.size(); ++n) {
    const Cluster& cluster = clusters[n];
    std::vector<VoxelIndex>& goals = goals_of[n];
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
  const std::vector<VoxelChange> changes = AsIfFree(knowledge.map(), knowledge.memory().set_aside());
  if (changes.empty()) return {};
  PlanningMap map = knowledge.map();
  map.Apply(changes);
  Hidden hidden;
  for (const Unseen& unseen :
       FindUnseen(map, knowledge, search_, goals_.finder(), options_.frontier.extent)) {
    hidden.voxels += unseen.cluster.unknowns.size();
    const std::optional<VoxelIndex> bar = unseen.Bar();
    if (bar && std::ranges::find(hidden.bars, *bar) == hidden.bars.end()) hidden.bars.push_back(*bar);
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
