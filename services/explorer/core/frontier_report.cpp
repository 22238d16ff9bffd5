#include "services/explorer/core/frontier_report.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

#include "services/explorer/core/map/open_border.h"

namespace thalweg::explorer {
namespace {

/// Voxels that were set aside for one reason.
struct AsideVoxels {
  AsideReason reason;
  bool doubtful;
  std::vector<VoxelIndex> voxels;
};

std::vector<AsideVoxels> SetAsideByReason(const Knowledge& knowledge) {
  std::vector<AsideVoxels> aside;
  for (auto& [reason, voxels] : knowledge.memory().SetAsideVoxels()) {
    std::vector<VoxelIndex> unknown;
    std::vector<VoxelIndex> doubtful;
    for (const VoxelIndex& i : voxels) (knowledge.map().Doubtful(i) ? doubtful : unknown).push_back(i);
    if (!unknown.empty()) aside.push_back({reason, false, std::move(unknown)});
    if (!doubtful.empty()) aside.push_back({reason, true, std::move(doubtful)});
  }
  return aside;
}

/// Number of unknown voxels; those of doubtful clusters are known.
std::size_t UnknownOf(std::span<const Candidate> candidates) {
  std::size_t voxels = 0;
  for (const Candidate& candidate : candidates) {
    if (!candidate.cluster.doubtful) voxels += candidate.cluster.unknowns.size();
  }
  return voxels;
}

/// As a share of what is known, in voxels.
constexpr double kMostBehindTightWays = 0.01;

double KnownVoxels(const PlanningMap& map) {
  const std::span states(map.states().data(), map.states().size());
  return static_cast<double>(states.size()) -
         static_cast<double>(std::ranges::count(states, VoxelState::kUnknown));
}

double Share(std::size_t part, std::size_t all) {
  return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
}

}  // namespace

std::vector<FrontierReport> ReportFrontiers(const Knowledge& knowledge, std::span<const Candidate> candidates,
                                            const Choice& choice) {
  using Fate = FrontierReport::Fate;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<FrontierReport> reports;
  for (std::size_t n = 0; n < candidates.size(); ++n) {
    const Candidate& candidate = candidates[n];
    const bool chosen = !choice.path_W.empty() && n == choice.candidate;
    reports.push_back({.center_W = candidate.cluster.center_W,
                       .voxels = candidate.cluster.unknowns.size(),
                       .length = candidate.length,
                       .score = n < choice.scores.size() ? choice.scores[n] : kNone,
                       .fate = chosen ? Fate::kChosen : Fate::kLeft,
                       .reason = AsideReason::kNone,
                       .doubtful = candidate.cluster.doubtful});
  }
  for (const auto& [reason, doubtful, voxels] : SetAsideByReason(knowledge)) {
    for (const std::vector<VoxelIndex>& component : ConnectedComponents(voxels)) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const VoxelIndex& i : component) sum += knowledge.map().CenterOf(i);
      reports.push_back({.center_W = sum / static_cast<double>(component.size()),
                         .voxels = component.size(),
                         .length = kNone,
                         .score = kNone,
                         .fate = Fate::kSetAside,
                         .reason = reason,
                         .doubtful = doubtful});
    }
  }
  return reports;
}

std::vector<SetAsideCount> CountSetAside(const Knowledge& knowledge, const Frontiers& frontiers) {
  std::vector<SetAsideCount> counts;
  for (const auto& [reason, doubtful, voxels] : SetAsideByReason(knowledge)) {
    counts.push_back({reason, doubtful, ConnectedComponents(voxels).size(), voxels.size()});
  }
  if (frontiers.small_clusters > 0) {
    counts.push_back({AsideReason::kTooSmall, false, frontiers.small_clusters, frontiers.small_voxels});
  }
  if (frontiers.small_doubtful_clusters > 0) {
    counts.push_back(
        {AsideReason::kTooSmall, true, frontiers.small_doubtful_clusters, frontiers.small_doubtful_voxels});
  }
  return counts;
}

double ShareOfBorder(const Knowledge& knowledge, std::span<const Candidate> candidates) {
  const OpenBorder border = FindOpenBorder(knowledge.map(), knowledge.memory().set_aside());
  return Share(UnknownOf(candidates), border.surface + border.open());
}

Ending EndingWithNothingLeft(const Knowledge& knowledge, double max_missed_share,
                             const CandidateSearch& search, std::span<const ShutWays::Way> shut,
                             std::span<const TightWay> tight) {
  const PlanningMap& map = knowledge.map();
  OpenBorder border = FindOpenBorder(map, knowledge.memory().set_aside());
  const double face = map.voxel_size() * map.voxel_size();  // [m^2] per voxel
  const std::size_t all = border.surface + border.open();
  Ending ending;
  std::size_t behind_ways = 0;
  for (const ShutWays::Way& way : shut) {
    behind_ways += way.unknowns;
    ending.shut_ways_W.push_back(map.CenterOf(way.bar));
  }
  ending.shut_area = static_cast<double>(behind_ways) * face;
  border.hidden = behind_ways;
  // Counted only where the ending depends on it
  if (border.share() > max_missed_share && border.missed_share() <= max_missed_share) {
    CandidateSearch::Hidden hidden = search.FindHidden(knowledge);
    border.hidden += hidden.voxels;
    ending.hidden_area = static_cast<double>(hidden.voxels) * face;
    ending.bars = std::move(hidden.bars);
  }
  double behind_tight = 0.0;  // [m^2]
  for (const TightWay& way : tight) {
    behind_tight += way.area;
    ending.tight_ways.push_back({way.place_W, way.area});
  }
  std::ranges::stable_sort(ending.tight_ways, std::greater<>(), &Ending::TightWay::area);
  if (border.missed_share() > max_missed_share ||
      behind_tight > kMostBehindTightWays * KnownVoxels(map) * face)
    ending.outcome = Outcome::kTooMuchUnknown;
  const std::vector<Candidate>& left = search.candidates();
  if (!left.empty()) {
    std::size_t& never_aside = border.unknown[AsideReason::kNone];
    const std::size_t voxels = std::min(never_aside, UnknownOf(left));
    ending.left_frontiers = static_cast<std::size_t>(
        std::ranges::count_if(left, [](const Candidate& candidate) { return !candidate.cluster.doubtful; }));
    ending.left_area = static_cast<double>(voxels) * face;
    never_aside -= voxels;
    if (never_aside == 0) border.unknown.erase(AsideReason::kNone);
  }
  for (const auto& [reason, voxels] : border.unknown) {
    const bool too_small = reason == AsideReason::kNone;  // or it would be a target
    ending.missed.push_back(
        {too_small ? AsideReason::kTooSmall : reason, static_cast<double>(voxels) * face});
  }
  ending.missed_area = static_cast<double>(border.open()) * face;
  ending.missed_share = Share(border.open(), all);
  for (std::size_t k = 0; k < map.doubtful().size(); ++k) {
    if (map.doubtful()[k] != 0 && IsTarget(map, map.states().IndexAt(k))) ++ending.doubtful_voxels;
  }
  if (knowledge.inspected() != nullptr) ending.surface = knowledge.inspected()->MeasureArea(map);
  return ending;
}

}  // namespace thalweg::explorer
