#include "services/explorer/core/target_chooser.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/base/stopwatch.h"
#include "common/geometry/polyline.h"
#include "common/voxel/for_each_voxel.h"
#include "services/explorer/core/frontier_report.h"
#include "services/explorer/core/turn_price.h"

namespace thalweg::explorer {
namespace {

/// Share of the border of free space that may stay unknown because going there is not worth the path.
constexpr double kMostLeft = 0.01;
/// [m] What bars a path lies within this distance beside the body.
constexpr double kBesideABar = 0.5;

/// The candidate with a voxel nearest to one of the places, if one is within `reach` [m].
std::optional<std::size_t> NearestTo(const std::vector<VoxelIndex>& places, const Situation& situation,
                                     double reach) {
  std::optional<std::size_t> nearest;
  for (std::size_t n = 0; n < situation.candidates.size(); ++n) {
    for (const VoxelIndex& i : situation.candidates[n].cluster.unknowns) {
      for (const VoxelIndex& place : places) {
        const double distance = (situation.map.CenterOf(i) - situation.map.CenterOf(place)).norm();
        if (distance > reach) continue;
        reach = distance;
        nearest = n;
      }
    }
  }
  return nearest;
}

}  // namespace

TargetChooser::TargetChooser(const ExplorerOptions& options, Knowledge& knowledge)
    : options_(options), search_(SearchOptions(options)), strategy_(options.strategy.make()) {
  Reset(knowledge);
}

std::optional<Error> TargetChooser::UseStrategy(std::string_view name, Knowledge& knowledge) try {
  Use(options_.configure(name), knowledge);
  return std::nullopt;
} catch (const std::invalid_argument& error) {
  return Error{error.what()};
}

void TargetChooser::TakeOverFrom(const TargetChooser& other, Knowledge& knowledge) {
  Use(other.options_.strategy, knowledge);
}

void TargetChooser::Use(ConfiguredStrategy strategy, Knowledge& knowledge) {
  strategy_ = strategy.make();
  options_.strategy = std::move(strategy);
  Reset(knowledge);
}

Task TargetChooser::Choose(const RigidTransform& T_WB, Time now, const TaskMaker& make,
                           const Mission& mission, Knowledge& knowledge, StageTimings& timings) {
  const PlanningMap& map = knowledge.map();
  const Eigen::Vector3d p_W = T_WB.translation();
  knowledge.Occupy(p_W);
  const bool finds_itself = TakeOwnCandidates(p_W, knowledge);
  if (!finds_itself) search_.Find(p_W, mission, now, knowledge, timings);
  const std::optional<Budget> dropped = search_.DropTooFar(map, mission, now);
  const auto too_far = [&](const InspectionView& view) {
    return mission.TooFar(map, view.length, map.CenterOf(view.place), now);
  };
  const auto inspect = [&](const InspectionView& view) {
    Task task = make.Inspect(view, search_.search(), T_WB);
    task.plan.frontiers = search_.candidates().size();
    return task;
  };
  // Looks at what may bar the path to the rest, from as near as can be; nothing if all of it is set aside
  const auto look_at_bar = [&](const std::vector<VoxelIndex>& bars) -> std::optional<Task> {
    if (bars.empty()) return std::nullopt;
    const double reach = options_.clearance() + kBesideABar;
    const int cells = static_cast<int>(std::ceil(reach / map.voxel_size()));
    for (const VoxelIndex& bar : bars) knowledge.memory().ReopenInVain(CubeAround(bar, cells));
    search_.FindSmallest(p_W, mission, now, knowledge, timings);
    const std::optional<Budget> spent = search_.DropTooFar(map, mission, now);
    const Situation situation = Describe(T_WB, knowledge);
    const std::optional<std::size_t> nearest = NearestTo(bars, situation, reach);
    if (!nearest) return spent ? std::optional(Ended(OutcomeOf(*spent))) : std::nullopt;
    return make.See(StraightTo(situation, *nearest), search_.candidates(), T_WB, timings, Approach::kNearest);
  };
  const auto end = [&] {
    Ending ending = EndingWithNothingLeft(knowledge, options_.max_missed_share, search_);
    if (!finds_itself && ending.outcome == Outcome::kTooMuchUnknown) {
      if (std::optional<Task> task = look_at_bar(ending.bars)) return *std::move(task);
    }
    return Ended(std::move(ending));
  };
  if (search_.candidates().empty()) {
    std::optional<Budget> spent = dropped;
    constexpr double kHoweverFar = std::numeric_limits<double>::infinity();
    if (const auto view = FindInspection(T_WB, kHoweverFar, knowledge, timings)) {
      spent = too_far(*view);
      if (!spent) return inspect(*view);
    }
    if (spent) return Ended(OutcomeOf(*spent));
    if (!finds_itself && IsShutIn(map, search_.search())) {
      std::optional<Task> task = look_at_bar(search_.FindHidden(knowledge).bars);
      return task ? *std::move(task) : EndedShutIn(map, p_W);
    }
    return end();
  }
  const Situation situation = Describe(T_WB, knowledge);
  const Stopwatch choosing;
  Choice choice = strategy_->Choose(situation);
  timings["choice"].Add(choosing.Milliseconds());
  if (const auto view = FindInspection(T_WB, PathLength(choice.path_W), knowledge, timings);
      view && !too_far(*view))
    return inspect(*view);
  if (finds_itself && choice.path_W.size() < 2) return EndedShutIn(map, p_W);
  if (choice.path_W.empty()) {  // nothing is worth its path
    if (dropped) return Ended(OutcomeOf(*dropped));
    if (ShareOfBorder(knowledge, search_.candidates()) <= kMostLeft) {
      const bool more = !finds_itself && search_.FindOutOfSight(p_W, mission, now, knowledge, timings);
      return more ? Choose(T_WB, now, make, mission, knowledge, timings) : end();
    }
    choice = StraightTo(situation, NearestCandidate(situation));
  }
  Task task = make.See(choice, search_.candidates(), T_WB, timings);
  const std::vector<RigidTransform>& T_WBs = task.plan.T_WBs;
  // A strategy may choose a detour that a budget does not allow, where the straight path is allowed.
  if (!finds_itself && mission.TooFar(map, PathLength(T_WBs), T_WBs.back().translation(), now)) {
    choice = StraightTo(situation, NearestCandidate(situation));
    task = make.See(choice, search_.candidates(), T_WB, timings);
  }
  return task;
}

bool TargetChooser::TakeOwnCandidates(const Eigen::Vector3d& p_W, const Knowledge& knowledge) {
  std::optional<std::vector<Candidate>> own =
      strategy_->FindCandidates({.map = knowledge.map(),
                                 .robot_W = p_W,
                                 .clearance = options_.clearance(),
                                 .set_aside = knowledge.memory().set_aside(),
                                 .min_area = options_.frontier.min_area});
  if (!own) return false;
  search_.Take(*std::move(own));
  return true;
}

Situation TargetChooser::Describe(const RigidTransform& T_WB, const Knowledge& knowledge) {
  const PlanningMap& map = knowledge.map();
  TimePrices prices;
  if (options_.minimize == Minimize::kTime) {
    prices.stop = PriceOfStop(options_.robot);
    prices.turn = [this, &map, T_WB](const VoxelIndex& place, double length, const Eigen::Vector3d& point_W) {
      return PriceOfTurn(place, length, point_W, T_WB, map, options_.camera, options_.robot);
    };
    search_.PriceTurns([&](const Candidate& candidate) {
      return prices.turn(candidate.goals.front(), candidate.length, candidate.cluster.center_W);
    });
  }
  return {.map = map,
          .search = search_.search(),
          .robot_W = T_WB.translation(),
          .clearance = options_.clearance(),
          .candidates = search_.candidates(),
          .views = knowledge.views(),
          .sensor_range = options_.sensor_range,
          .look_range = options_.look_range,
          .pull_straight = options_.loop.pull_straight,
          .time = std::move(prices)};
}

Task TargetChooser::EndedShutIn(const PlanningMap& map, const Eigen::Vector3d& p_W) const {
  return Ended(
      Ending{.outcome = Outcome::kNothingReachable,
             .shut_in = WhyShutIn(map, p_W, options_.robot.radius, {options_.wide_exemption, true})});
}

std::optional<InspectionView> TargetChooser::FindInspection(const RigidTransform& T_WB, double max_length,
                                                            Knowledge& knowledge, StageTimings& timings) {
  if (!inspection_.wanted()) return std::nullopt;
  const Stopwatch finding;
  std::optional<InspectionView> view = inspection_.Find(knowledge, search_.search(), T_WB, max_length);
  timings["inspection"].Add(finding.Milliseconds());
  return view;
}

}  // namespace thalweg::explorer
