#include "services/explorer/core/target_chooser.h"

#include <algorithm>
#include <array>
#include <cmath>
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
constexpr double kElsewhere = 0.1;  // [m] So far away, there may be room to turn where there was none.

void CheckRobot(const RobotModel& robot, const ConfiguredStrategy& strategy) {
  const std::optional<RobotMisfit> misfit = MisfitOf(robot, strategy.name);
  if (!misfit) return;
  throw std::invalid_argument("the strategy " + strategy.name + " is for " + misfit->robots + ", and robot." +
                              misfit->field + " is " + misfit->value);
}

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
    : options_(options),
      search_(SearchOptions(options)),
      shut_ways_(ShutWayOptions(options)),
      looks_(options),
      strategy_(options.strategy.make()),
      gets_views_(strategy_->goes_by_views()) {
  CheckRobot(options.robot, options.strategy);
  Reset(knowledge);
}

void TargetChooser::Reset(Knowledge& knowledge) {
  inspection_.Follow(*strategy_, knowledge);
  shut_ways_.Clear();
  tried_again_W_.reset();
}

std::optional<Error> TargetChooser::UseStrategy(std::string_view name, Knowledge& knowledge) try {
  ConfiguredStrategy strategy = options_.configure(name);
  CheckRobot(options_.robot, strategy);
  if (!gets_views_ && strategy.make()->goes_by_views())
    return Error{"the strategy " + strategy.name +
                 " goes by views of the camera, which only an explorer gets that began with such a strategy"};
  Use(std::move(strategy), knowledge);
  return std::nullopt;
} catch (const std::invalid_argument& error) {
  return Error{error.what()};
}

void TargetChooser::TakeOverFrom(const TargetChooser& other, Knowledge& knowledge) {
  left_out_before_ = other.left_out();
  gone_tight_way_ = other.gone_tight_way_;
  Use(other.options_.strategy, knowledge);
}

void TargetChooser::Use(ConfiguredStrategy strategy, Knowledge& knowledge) {
  std::unique_ptr<Strategy> next = strategy.make();
  left_out_before_ += strategy_->left_out();
  strategy_ = std::move(next);
  options_.strategy = std::move(strategy);
  inspection_.Follow(*strategy_, knowledge);
}

Task TargetChooser::Choose(const RigidTransform& T_WB, Time now, const TaskMaker& make,
                           const Mission& mission, Knowledge& knowledge, GoingBack& going_back,
                           StageTimings& timings) {
  knowledge.Occupy(T_WB.translation());
  Task task = ChooseAt({T_WB, now, make, mission, knowledge, going_back, timings});
  if (!task.plan.ending && task.plan.purpose != Purpose::kGoBack) going_back.GoesOn();
  return task;
}

Task TargetChooser::ChooseAt(Moment moment) {
  moment.finds_itself = TakeOwnCandidates(moment.p_W(), moment.knowledge);
  if (!moment.finds_itself) {
    search_.Find(moment.p_W(), moment.mission, moment.now, moment.knowledge, moment.timings);
    shut_ways_.Note(search_.search());
  }
  if (const auto place_W = strategy_->FindMisfit(moment.map(), search_.search()))
    return Ended(Ending{.outcome = Outcome::kDoesNotApply, .misfit_W = place_W});
  return Decide(moment);
}

Task TargetChooser::Decide(Moment moment) {
  moment.dropped_for = search_.DropTooFar(moment.map(), moment.mission, moment.now);
  return search_.candidates().empty() ? DecideWithoutCandidates(moment) : DecideAmongCandidates(moment);
}

Task TargetChooser::DecideAmongCandidates(const Moment& moment) {
  const Situation situation = Describe(moment.T_WB, moment.knowledge);
  const Stopwatch choosing;
  Choice choice = strategy_->Choose(situation);
  moment.timings["choice"].Add(choosing.Milliseconds());
  std::optional<VoxelIndex> frontier;
  if (!choice.path_W.empty()) frontier = moment.map().IndexOf(choice.path_W.back());
  const auto view = NextInspection(frontier, moment);
  if (view && !moment.TooFar(*view)) return Inspect(*view, moment);
  if (moment.finds_itself && choice.path_W.size() < 2) return EndedShutIn(moment);
  if (choice.path_W.empty()) {
    if (std::optional<Task> task = DecideWithoutWorth(moment)) return *std::move(task);
    choice = StraightTo(situation, NearestCandidate(situation));
  }
  if (std::optional<Task> task = See(choice, situation, moment)) return *std::move(task);
  return DecideWithout(choice, moment);
}

/// Decides again without a choice that the robot has no room to turn to.
Task TargetChooser::DecideWithout(const Choice& choice, const Moment& moment) {
  const Candidate chosen = search_.candidates()[choice.candidate];
  SetAsideForRoom(choice.target.empty() ? chosen.cluster.unknowns : choice.target, moment);
  const DenseGrid<std::uint8_t>& aside = moment.knowledge.memory().set_aside();
  search_.Drop([&](const Candidate& candidate) {
    return candidate.cluster.unknowns == chosen.cluster.unknowns ||
           std::ranges::all_of(candidate.cluster.unknowns,
                               [&](const VoxelIndex& i) { return aside[i] != 0; });
  });
  return Decide(moment);
}

void TargetChooser::SetAsideForRoom(const std::vector<VoxelIndex>& target, const Moment& moment) {
  for (const VoxelIndex& i : target) moment.knowledge.memory().SetAside(i, AsideReason::kNoRoom, moment.now);
}

Task TargetChooser::DecideWithoutCandidates(const Moment& moment) {
  const bool is_elsewhere = !tried_again_W_ || (*tried_again_W_ - moment.p_W()).norm() > kElsewhere;
  if (is_elsewhere && moment.knowledge.memory().Release(AsideReason::kNoRoom, moment.now) > 0) {
    tried_again_W_ = moment.p_W();
    return ChooseAt(moment);
  }
  std::optional<Budget> spent = moment.dropped_for;
  if (strategy_->end() && !spent) return EndedBy(*strategy_->end(), moment);
  if (const auto view = NextInspection(std::nullopt, moment)) {
    spent = moment.TooFar(*view);
    if (!spent) return Inspect(*view, moment);
  }
  if (spent) return Ended(OutcomeOf(*spent));
  const bool reaches_little = !moment.finds_itself && IsShutIn(moment.map(), search_.search());
  if (!moment.finds_itself && !reaches_little) gone_tight_way_ = false;
  // A robot that has gone a tight way may reach less than half from where it is, and is not shut in.
  const bool beyond_tight_way = gone_tight_way_ && search_.search().reached_count() > 0;
  if (reaches_little && !beyond_tight_way) {
    std::optional<Task> task = LookAtBar(search_.FindHidden(moment.knowledge).bars, moment);
    if (!task) task = WatchShutWay(FindShutWays(moment), moment);
    if (!task) task = GoTightWay(FindTightWays(moment), moment);
    if (!task) task = moment.going_back.ToMostOfSpace(moment.T_WB, moment.map(), moment.make);
    return task ? *std::move(task) : EndedShutIn(moment);
  }
  return EndOrLookAtBar(moment);
}

std::optional<Task> TargetChooser::DecideWithoutWorth(const Moment& moment) {
  if (moment.dropped_for) return Ended(OutcomeOf(*moment.dropped_for));
  if (ShareOfBorder(moment.knowledge, search_.candidates()) > kMostLeft) return std::nullopt;
  if (moment.finds_itself || moment.took_out_of_sight ||
      !search_.FindOutOfSight(moment.p_W(), moment.mission, moment.now, moment.knowledge, moment.timings))
    return EndOrLookAtBar(moment);
  // Among these: which voxels form a cluster, and whether it is seen, depends on what is set aside, so that
  // another search might set aside again what has just come into sight.
  Moment again = moment;
  again.took_out_of_sight = true;
  return Decide(again);
}

Task TargetChooser::EndedBy(const StrategyEnd& end, const Moment& moment) const {
  if (!end.completes) return Ended(Ending{.outcome = Outcome::kCannotGoOn, .why = end.why});
  Ending ending = EndingWithNothingLeft(moment.knowledge, options_.max_missed_share, search_, {});
  ending.why = end.why;
  ending.missed.clear();  // nobody has looked at it by intent
  return Ended(std::move(ending));
}

std::optional<Task> TargetChooser::See(Choice& choice, const Situation& situation, const Moment& moment) {
  if (strategy_->goes_by_views()) return moment.make.TakeView(choice, search_.candidates(), moment.T_WB);
  const auto too_far = [&](const std::optional<Task>& task) {
    if (!task || moment.finds_itself) return std::optional<Budget>();
    const std::vector<RigidTransform>& T_WBs = task->plan.T_WBs;
    return moment.mission.TooFar(moment.map(), PathLength(T_WBs), T_WBs.back().translation(), moment.now);
  };
  std::optional<Task> task = moment.make.See(choice, search_.candidates(), moment.T_WB, moment.timings);
  // A strategy may choose a detour that a budget does not allow, where the straight path is allowed.
  if (!too_far(task)) return task;
  choice = StraightTo(situation, NearestCandidate(situation));
  task = moment.make.See(choice, search_.candidates(), moment.T_WB, moment.timings);
  if (options_.robot.turns_on_the_spot()) return task;
  // In curves even that may be too long.
  const std::optional<Budget> spent = too_far(task);
  return spent ? Ended(OutcomeOf(*spent)) : task;
}

Task TargetChooser::Inspect(const InspectionView& view, const Moment& moment) {
  std::optional<Task> task = moment.make.Inspect(view, search_.search(), moment.T_WB);
  if (!task) {
    InspectedSurface& surface = *moment.knowledge.inspected();
    for (const Facet& facet : view.facets) surface.CountTry(facet);
    Moment again = moment;
    // Where there is nothing else to do, the next view is tried.
    again.has_no_room_to_inspect = !search_.candidates().empty();
    return Decide(again);
  }
  task->plan.frontiers = search_.candidates().size();
  return *std::move(task);
}

std::optional<Task> TargetChooser::LookAtBar(const std::vector<VoxelIndex>& bars, const Moment& moment) {
  if (bars.empty()) return std::nullopt;
  const double reach = options_.clearance() + kBesideABar;
  const int cells = static_cast<int>(std::ceil(reach / moment.map().voxel_size()));
  for (const VoxelIndex& bar : bars) moment.knowledge.memory().ReopenInVain(CubeAround(bar, cells));
  search_.FindSmallest(moment.p_W(), moment.mission, moment.now, moment.knowledge, moment.timings);
  const std::optional<Budget> spent = search_.DropTooFar(moment.map(), moment.mission, moment.now);
  const Situation situation = Describe(moment.T_WB, moment.knowledge);
  const std::optional<std::size_t> nearest = NearestTo(bars, situation, reach);
  if (!nearest) return spent ? std::optional(Ended(OutcomeOf(*spent))) : std::nullopt;
  std::optional<Task> task = moment.make.See(StraightTo(situation, *nearest), search_.candidates(),
                                             moment.T_WB, moment.timings, Approach::kNearest);
  if (!task) SetAsideForRoom(situation.candidates[*nearest].cluster.unknowns, moment);
  return task;
}

std::vector<ShutWays::Way> TargetChooser::FindShutWays(const Moment& moment) const {
  if (moment.finds_itself) return {};
  return shut_ways_.Find(moment.knowledge, search_.search());
}

std::optional<Task> TargetChooser::WatchShutWay(const std::vector<ShutWays::Way>& ways,
                                                const Moment& moment) {
  for (const ShutWays::Way& way : ways) {
    if (!shut_ways_.MayWatch(way)) continue;
    const Errand look{.kind = Errand::Kind::kLookAt, .p_W = moment.map().CenterOf(way.bar)};
    Result<Task> task =
        looks_.MakeTask(look, moment.T_WB, moment.now, moment.make, moment.mission, moment.knowledge);
    if (!task) {
      shut_ways_.GiveUp(way);
      continue;
    }
    if (task->plan.kind == Plan::Kind::kLook) {
      shut_ways_.Watch(way, moment.now);
      task->plan.dwell = kBetweenLooksAtShutWay;
    }
    if (!shut_ways_.MayWatch(way)) continue;
    task->plan.purpose = Purpose::kWatchShutWay;
    return *std::move(task);
  }
  return std::nullopt;
}

void TargetChooser::DidNotGetThere(const Task& task, const PlanningMap& map) {
  if (task.plan.purpose == Purpose::kWatchShutWay && task.plan.target_W)
    shut_ways_.DidNotGetTo(map.IndexOf(*task.plan.target_W));
}

std::vector<TightWay> TargetChooser::FindTightWays(const Moment& moment) const {
  if (moment.finds_itself) return {};
  return explorer::FindTightWays(moment.knowledge, search_.search(), moment.p_W(), options_.robot.radius,
                                 GoalFinder(options_.look_range, moment.map().voxel_size()),
                                 options_.frontier.extent);
}

std::optional<Task> TargetChooser::GoTightWay(const std::vector<TightWay>& ways, const Moment& moment) {
  // The path home is one from voxel to voxel.
  if (!options_.loop.go_tight_ways || moment.mission.returns_home()) return std::nullopt;
  // Arcs keep to no line between voxels.
  if (!options_.robot.turns_on_the_spot()) return std::nullopt;
  for (const TightWay& way : ways) {
    const double length = PathLength(way.path_W);
    // The area of clusters that can also be seen by another way may be counted there.
    const bool small =
        way.area < options_.frontier.min_area &&
        way.nearest.unknowns.size() < VoxelsOfArea(options_.frontier.min_area, moment.map().voxel_size());
    if (way.path_W.empty() || small ||
        moment.mission.TooFar(moment.map(), length, way.path_W.back(), moment.now))
      continue;
    const std::vector<Candidate> candidates = {
        {.cluster = way.nearest, .goals = {moment.map().IndexOf(way.path_W.back())}, .length = length}};
    // It is in sight from there; what is still not seen then was visited in vain.
    moment.knowledge.memory().Release(AsideReason::kOutOfSight, way.nearest.unknowns);
    std::optional<Task> task = moment.make.See({.candidate = 0, .path_W = way.path_W}, candidates,
                                               moment.T_WB, moment.timings, Approach::kNearest);
    if (!task) continue;
    gone_tight_way_ = true;
    task->choice = {};  // which is none of the candidates that the search has found
    task->plan.frontiers = search_.candidates().size() + 1;
    return task;
  }
  return std::nullopt;
}

Task TargetChooser::EndOrLookAtBar(const Moment& moment) {
  const std::vector<ShutWays::Way> shut = FindShutWays(moment);
  const std::vector<TightWay> tight = FindTightWays(moment);
  if (std::optional<Task> task = GoTightWay(tight, moment)) return *std::move(task);
  Ending ending = EndingWithNothingLeft(moment.knowledge, options_.max_missed_share, search_, shut, tight);
  if (!moment.finds_itself && ending.outcome == Outcome::kTooMuchUnknown) {
    if (std::optional<Task> task = LookAtBar(ending.bars, moment)) return *std::move(task);
  }
  if (std::optional<Task> task = WatchShutWay(shut, moment)) return *std::move(task);
  return Ended(std::move(ending));
}

bool TargetChooser::TakeOwnCandidates(const Eigen::Vector3d& p_W, const Knowledge& knowledge) {
  const std::array exemptions = {PathSearch::Exemption{options_.exemption},
                                 PathSearch::Exemption{options_.wide_exemption, true}};
  std::optional<std::vector<Candidate>> own =
      strategy_->FindCandidates({.map = knowledge.map(),
                                 .robot_W = p_W,
                                 .clearance = options_.clearance(),
                                 .set_aside = knowledge.memory().set_aside(),
                                 .min_area = options_.frontier.min_area,
                                 .radius = options_.robot.radius,
                                 .exemptions = exemptions,
                                 .pull_straight = options_.loop.pull_straight});
  if (!own) return false;
  search_.Take(*std::move(own));
  return true;
}

Situation TargetChooser::Describe(const RigidTransform& T_WB, const Knowledge& knowledge) {
  const PlanningMap& map = knowledge.map();
  std::optional<TimedRobot> timed;
  if (options_.minimize == Minimize::kTime || !options_.robot.turns_on_the_spot()) {
    timed = {options_.robot, T_WB.linear()};
    search_.PriceTurns([&](const Candidate& candidate) {
      return PriceOfTurn(candidate.goals.front(), candidate.length, candidate.cluster.center_W, T_WB, map,
                         options_.camera, options_.robot);
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
          .time = timed};
}

Task TargetChooser::EndedShutIn(const Moment& moment) const {
  return Ended(Ending{.outcome = Outcome::kNothingReachable,
                      .shut_in = WhyShutIn(moment.map(), moment.p_W(), options_.robot.radius,
                                           {options_.wide_exemption, true})});
}

std::optional<InspectionView> TargetChooser::NextInspection(const std::optional<VoxelIndex>& frontier,
                                                            const Moment& moment) {
  if (!inspection_.wanted() || moment.has_no_room_to_inspect) return std::nullopt;
  const Stopwatch finding;
  std::optional<InspectionView> view =
      inspection_.Next(moment.knowledge, search_.search(), moment.T_WB, frontier);
  moment.timings["inspection"].Add(finding.Milliseconds());
  return view;
}

}  // namespace thalweg::explorer
