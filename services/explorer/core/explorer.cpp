#include "services/explorer/core/explorer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "common/base/stage_names.h"
#include "common/base/stopwatch.h"
#include "common/geometry/point_text.h"
#include "common/geometry/polyline.h"
#include "services/explorer/core/aftermath.h"
#include "services/explorer/core/no_go_paths.h"
#include "services/explorer/core/path/flyable_path.h"
#include "services/explorer/core/turn_price.h"
#include "services/explorer/core/view/aiming.h"

namespace thalweg::explorer {
namespace {

constexpr double kSamePosition = 0.05;  // [m]
/// Share of the border of free space that may stay unknown because going there is not worth the path.
constexpr double kMostLeft = 0.01;

Plan Done(Ending ending) {
  Plan plan;
  plan.ending = std::move(ending);
  return plan;
}

Plan Done(Outcome outcome) {
  return Done(Ending{.outcome = outcome});
}

Plan DoneShutIn(const PlanningMap& map, const Eigen::Vector3d& p_W, const Explorer::Options& options) {
  return Done(Ending{.outcome = Outcome::kNothingReachable,
                     .shut_in = WhyShutIn(map, p_W, options.robot.radius, {options.wide_exemption, true})});
}

}  // namespace

Explorer::Explorer(const Options& options)
    : options_(WithLoopRules(ReachingBeyondItsFeet(options))),
      knowledge_(KnowledgeOptions(options_)),
      mission_(MissionOptions(options_)),
      search_(SearchOptions(options_)),
      strategy_(options.strategy.make()),
      goal_finder_(options.look_range, options.voxel_size),
      no_go_(NoGoOptions(options_)) {
  Check(options);
  inspection_.Follow(*strategy_, knowledge_);
}

void Explorer::Reset() {
  knowledge_.Reset();
  inspection_.Follow(*strategy_, knowledge_);  // what is known of surface is of the old map, too
  has_left_start_ = false;
  blind_look_.Reset();
  task_ = {};
  after_turn_.reset();
  map_is_new_ = true;
}

void Explorer::Update(std::span<const VoxelChange> changes, std::span<const ScanView> scans, Time now) {
  updated_ = now;
  knowledge_.Update(changes, scans, now);
  if (std::exchange(map_is_new_, false)) asides_.SetAsideAgain(knowledge_, now);
}

void Explorer::SaveTo(SavedExploration& saved, Time now) const {
  saved.home_W = mission_.home_paths().home_W();
  saved.distance = mission_.distance();
  saved.elapsed = mission_.Elapsed(now);
  saved.homeward = mission_.homeward();
  saved.strategy = options_.strategy.name;
  saved.drawn = no_go_.drawn();
  saved.aside.clear();
  asides_.SaveTo(saved.aside, knowledge_);
}

void Explorer::Restore(const SavedExploration& saved) {
  mission_.Restore(saved);
  for (const Eigen::AlignedBox3d& box_W : saved.drawn) no_go_.Draw(box_W);
  UseStrategy(saved.strategy);  // one that is gone leaves the scenario's
  asides_.Restore(saved.aside);
}

void Explorer::ShiftTimes(Duration back) {
  mission_.ShiftTimes(back);
  updated_ -= back;
  knowledge_.memory().ShiftTimes(back);
}

void Explorer::Arrived(Time now) {
  RememberArrival(task_, knowledge_, now);
  task_.DropTarget();
}

void Explorer::GotLost(Time now) {
  RememberLoss(task_, knowledge_, now);
  task_.DropTarget();
}

std::optional<Interruption> Explorer::CheckPlan(const RigidTransform& T_WB) const {
  if (minimizes_time() && task_.plan.faces_passage_first && after_turn_ &&
      AngleBetween(T_WB, after_turn_->plan.T_WBs.front()) < AngleWellInView(options_.camera, options_.robot))
    return Interruption::kTargetSeen;
  if (minimizes_time() && task_.plan.purpose == Purpose::kLookAround && !task_.target.empty() &&
      TargetIsSeen())
    return Interruption::kTargetSeen;
  if (task_.plan.kind != Plan::Kind::kGo && task_.plan.T_WBs.size() < 2) return std::nullopt;
  const Eigen::Vector3d p_W = T_WB.translation();
  if (!task_.StillClear(map(), p_W, least_clearance())) return Interruption::kPathBlocked;
  if (!task_.FacesNarrowPassage(T_WB)) return Interruption::kNotFacingPassage;
  if (mission_.homeward()) return std::nullopt;
  if (const std::optional<Budget> budget = mission_.HomeIsDue(map(), p_W, updated_)) {
    return HomeIsDue(*budget);
  }
  if (task_.plan.kind != Plan::Kind::kGo) return std::nullopt;
  if (task_.plan.purpose == Purpose::kInspect && options_.loop.scan_on_the_way &&
      AreInspected(task_.facets, knowledge_, options_.resolved_share))
    return Interruption::kTargetSeen;
  if (task_.plan.purpose != Purpose::kSeeFrontier || !options_.loop.scan_on_the_way) return std::nullopt;
  return TargetIsSeen() ? std::optional(Interruption::kTargetSeen) : std::nullopt;
}

bool Explorer::TargetIsSeen() const {
  const auto known = static_cast<double>(task_.KnownOfTarget(map()));
  return known >= options_.resolved_share * static_cast<double>(task_.target.size());
}

std::optional<Task::Departure> Explorer::DepartureOf(const RigidTransform& T_WB, double speed) const {
  if (!minimizes_time() || !(speed > 0.0)) return std::nullopt;
  const double decides = options_.decision_time;
  const double brakes = 0.5 * speed * speed / options_.robot.max_acceleration;
  return task_.DepartAhead(T_WB, speed * decides + brakes,
                           decides + 0.5 * speed / options_.robot.max_acceleration,
                           options_.robot.max_turn_rate);
}

bool Explorer::CanReplan(const RigidTransform& T_WB, double speed) const {
  if (!minimizes_time()) return false;
  if (!(speed > 0.0)) return true;
  const std::optional<Task::Departure> departure = DepartureOf(T_WB, speed);
  if (!departure) return false;
  const std::vector<RigidTransform>& lead = departure->lead.T_WBs;
  for (std::size_t n = 1; n < lead.size(); ++n) {
    if (!map().SegmentClear(lead[n - 1].translation(), lead[n].translation(),
                            PlanningMap::Obstacles::kOccupied, least_clearance()))
      return false;
  }
  return true;
}

Plan Explorer::MakePlan(const RigidTransform& T_WB_reported, Time now, double speed) {
  const Stopwatch whole;
  const std::optional<Task::Departure> departure = DepartureOf(knowledge_.InPlane(T_WB_reported), speed);
  lead_ = departure ? std::optional(departure->lead) : std::nullopt;
  const RigidTransform T_WB = BeginPlan(departure ? departure->T_WB : T_WB_reported, now);
  if (!PlanDuty(T_WB, now)) {
    task_.plan = Explore(T_WB, now);
    if (mission_.returns_home() && task_.plan.ending) {
      mission_.TurnHome(*task_.plan.ending);
      task_.plan = GoHome(T_WB);
    }
  }
  return FinishPlan(whole.Milliseconds());
}

Result<Plan> Explorer::MakePlanFor(const Errand& errand, const RigidTransform& T_WB_reported, Time now) {
  const Stopwatch whole;
  lead_.reset();
  const RigidTransform T_WB = BeginPlan(T_WB_reported, now);
  if (!PlanDuty(T_WB, now)) {
    Result<Plan> plan = Carry(errand, T_WB, now);
    if (!plan) {
      task_ = {};
      return Error{plan.error()};
    }
    task_.plan = *plan;
  }
  return FinishPlan(whole.Milliseconds());
}

RigidTransform Explorer::BeginPlan(const RigidTransform& T_WB_reported, Time now) {
  const RigidTransform T_WB = knowledge_.InPlane(T_WB_reported);
  ++plans_;
  task_.choice = {};
  task_.turn_first = false;
  knowledge_.memory().Expire(now);
  no_go_.PutUp(T_WB.translation(), knowledge_);
  mission_.FindPathsHome(map(), T_WB.translation());
  return T_WB;
}

bool Explorer::PlanDuty(const RigidTransform& T_WB, Time now) {
  if (const std::optional<Budget> spent = BudgetSpent(now)) {
    task_.plan = Done(OutcomeOf(*spent));
    return true;
  }
  if (ResumeAfterTurn(T_WB)) return true;
  if (mission_.homeward() && mission_.EndingAtHome(T_WB.translation())) {
    task_.plan = GoHome(T_WB);  // it has arrived, even if a box was drawn around its home meanwhile
    return true;
  }
  if (std::optional<Plan> leave = LeaveNoGo(T_WB)) {
    task_.plan = *std::move(leave);
    return true;
  }
  if (!mission_.homeward()) {
    if (const auto budget = mission_.HomeIsDue(map(), T_WB.translation(), now)) {
      mission_.TurnHome({.outcome = OutcomeOf(*budget)});
    }
  }
  if (!mission_.homeward()) return false;
  task_.plan = GoHome(T_WB);
  return true;
}

Plan Explorer::FinishPlan(double milliseconds) {
  if (task_.turn_first) task_.plan = TurnFirst();
  if (lead_ && !task_.plan.ending) {
    // A path begins on the last segment of what leads to it, see Follow.
    if (task_.plan.kind == Plan::Kind::kGo || task_.plan.faces_passage_first) {
      lead_->T_WBs.pop_back();
      lead_->narrow.pop_back();
    }
    task_.Prepend(*lead_, map(), least_clearance());
  }
  lead_.reset();
  task_.plan.homeward = mission_.homeward();
  timings_[kPlanStage].Add(milliseconds);
  return task_.plan;
}

Plan Explorer::TurnFirst() {
  Plan turn = task_.plan;
  turn.kind = Plan::Kind::kLook;
  turn.faces_passage_first = true;
  turn.T_WBs = {task_.plan.T_WBs.front()};
  after_turn_ = task_;
  task_.DropTarget();
  return turn;
}

bool Explorer::ResumeAfterTurn(const RigidTransform& T_WB) {
  if (!after_turn_) return false;
  task_ = *std::exchange(after_turn_, std::nullopt);
  task_.turn_first = false;
  const double off = (T_WB.translation() - task_.plan.T_WBs.front().translation()).norm();
  if (off <= kSamePosition && !CheckPlan(T_WB)) return true;
  task_ = {};
  return false;
}

Plan Explorer::Explore(const RigidTransform& T_WB, Time now) {
  if (!KnowsPlace(T_WB)) return LookForSpace(T_WB);
  blind_look_.Reset();
  if (options_.loop.look_around && !lead_) {
    if (std::optional<Plan> look = LookAround(T_WB)) return *look;
  }
  const Eigen::Vector3d p_W = T_WB.translation();
  knowledge_.Occupy(p_W);
  const bool finds_itself = TakeOwnCandidates(p_W);
  if (!finds_itself) search_.Find(p_W, mission_, now, knowledge_, timings_);
  std::optional<Budget> too_far = search_.DropTooFar(map(), mission_, now);
  if (search_.candidates().empty()) {
    if (const auto view = FindInspection(T_WB, std::numeric_limits<double>::infinity())) {
      too_far = mission_.TooFar(map(), view->length, map().CenterOf(view->place), now);
      if (!too_far) return Inspect(*view, T_WB);
    }
    if (too_far) return Done(OutcomeOf(*too_far));
    return !finds_itself && IsShutIn(map(), search_.search())
               ? DoneShutIn(map(), p_W, options_)
               : Done(EndingWithNothingLeft(knowledge_, options_.max_missed_share));
  }
  const auto price_of_turn = [&](const VoxelIndex& place, double length, const Eigen::Vector3d& point_W) {
    return PriceOfTurn(place, length, point_W, T_WB, map(), options_.camera, options_.robot);
  };
  if (minimizes_time())
    search_.PriceTurns([&](const Candidate& candidate) {
      return price_of_turn(candidate.goals.front(), candidate.length, candidate.cluster.center_W);
    });
  const Situation situation{
      map(),
      search_.search(),
      p_W,
      clearance(),
      search_.candidates(),
      knowledge_.views(),
      options_.sensor_range,
      options_.look_range,
      options_.loop.pull_straight,
      minimizes_time() ? TimePrices{PriceOfStop(options_.robot), price_of_turn} : TimePrices{}};
  const Stopwatch choosing;
  task_.choice = strategy_->Choose(situation);
  timings_["choice"].Add(choosing.Milliseconds());
  if (const auto view = FindInspection(T_WB, PathLength(task_.choice.path_W));
      view && !mission_.TooFar(map(), view->length, map().CenterOf(view->place), now))
    return Inspect(*view, T_WB);
  if (finds_itself && task_.choice.path_W.size() < 2) return DoneShutIn(map(), p_W, options_);
  if (task_.choice.path_W.empty()) {  // nothing is worth its path
    if (too_far) return Done(OutcomeOf(*too_far));
    if (ShareOf(search_.candidates(), knowledge_) <= kMostLeft)
      return Done(EndingWithNothingLeft(knowledge_, options_.max_missed_share, search_.candidates()));
    task_.choice = StraightTo(situation, NearestCandidate(situation));
  }
  has_left_start_ = true;
  Plan plan = GoTo(task_.choice, T_WB);
  if (!finds_itself && mission_.TooFar(map(), PathLength(plan.T_WBs), plan.T_WBs.back().translation(), now)) {
    // because strategies may choose detours
    task_.choice = StraightTo(situation, NearestCandidate(situation));
    plan = GoTo(task_.choice, T_WB);
  }
  return plan;
}

std::optional<InspectionView> Explorer::FindInspection(const RigidTransform& T_WB, double max_length) {
  if (!inspection_.wanted()) return std::nullopt;
  const Stopwatch finding;
  std::optional<InspectionView> view = inspection_.Find(knowledge_, search_.search(), T_WB, max_length);
  timings_["inspection"].Add(finding.Milliseconds());
  return view;
}

Plan Explorer::Inspect(const InspectionView& view, const RigidTransform& T_WB) {
  has_left_start_ = true;
  task_.choice = {};
  task_.DropTarget();
  Plan plan;
  if (view.length > 0.0) {
    const std::vector<Eigen::Vector3d> path_W =
        PullStraight(map(), search_.search().PathFrom(map(), T_WB.translation(), view.place), clearance());
    plan = Follow(MakeComfortable(map(), path_W, options_.comfort), view.R_WB, T_WB);
  } else {
    plan.kind = Plan::Kind::kLook;
    plan.T_WBs = {MakeTransform(view.R_WB, T_WB.translation())};
  }
  DescribeInspection(view, map(), plan);
  plan.frontiers = search_.candidates().size();
  task_.facets = view.facets;
  return plan;
}

bool Explorer::TakeOwnCandidates(const Eigen::Vector3d& p_W) {
  std::optional<std::vector<Candidate>> own =
      strategy_->FindCandidates({.map = map(),
                                 .robot_W = p_W,
                                 .clearance = clearance(),
                                 .set_aside = memory().set_aside(),
                                 .min_area = options_.frontier.min_area});
  if (!own) return false;
  search_.Take(*std::move(own));
  return true;
}

Plan Explorer::GoHome(const RigidTransform& T_WB) {
  const Eigen::Vector3d p_W = T_WB.translation();
  task_.DropTarget();
  if (std::optional<Ending> ending = mission_.EndingAtHome(p_W)) return Done(std::move(*ending));
  std::vector<Eigen::Vector3d> path_W = mission_.home_paths().PathFrom(map(), p_W);
  if (path_W.empty()) return Done(Outcome::kNoPathHome);
  path_W = MakeComfortable(map(), PullStraight(map(), path_W, clearance()), options_.comfort);
  Plan plan = Follow(path_W, T_WB.linear(), T_WB);
  plan.purpose = Purpose::kGoHome;
  plan.target_W = *mission_.home_paths().home_W();
  return plan;
}

Result<Plan> Explorer::Carry(const Errand& errand, const RigidTransform& T_WB, Time now) {
  knowledge_.Occupy(T_WB.translation());
  Result<ErrandPath> found = FindErrandPath(errand, T_WB, knowledge_, goal_finder_,
                                            {.robot_radius = options_.robot.radius,
                                             .exemption = options_.exemption,
                                             .wide_exemption = options_.wide_exemption,
                                             .sensor_range = options_.sensor_range});
  if (!found) return Error{found.error()};
  const bool goes = errand.kind == Errand::Kind::kGoTo;
  task_.DropTarget();
  Plan plan;
  if (found->path_W.size() == 1) {
    plan.kind = Plan::Kind::kLook;
    plan.T_WBs = {MakeTransform(found->R_WB, T_WB.translation())};
  } else {
    const std::vector<Eigen::Vector3d> path_W =
        MakeComfortable(map(), PullStraight(map(), found->path_W, clearance()), options_.comfort);
    if (const auto budget = mission_.TooFar(map(), PathLength(path_W), path_W.back(), now))
      return Error{"the rest of the " + std::string(ToText(OutcomeOf(*budget))) + " does not allow it"};
    plan = Follow(path_W, found->R_WB, T_WB);
  }
  plan.purpose = goes ? Purpose::kGoTo : Purpose::kLookAt;
  plan.target_W = errand.p_W;
  return plan;
}

std::optional<Plan> Explorer::LeaveNoGo(const RigidTransform& T_WB) {
  if (!no_go_.robot_inside()) return std::nullopt;
  task_.DropTarget();
  const std::vector<Eigen::Vector3d> path_W = PathOutOfNoGo(T_WB.translation(), no_go_, mission_, knowledge_);
  if (path_W.empty()) return Done(Outcome::kNothingReachable);
  Plan plan = Follow(PullStraight(map(), path_W, clearance()), T_WB.linear(), T_WB);
  plan.purpose = Purpose::kLeaveNoGo;
  plan.target_W = path_W.back();
  return plan;
}

void Explorer::Abandon() {
  after_turn_.reset();
}

std::optional<Error> Explorer::CheckErrand(const Errand& errand, const RigidTransform& T_WB_reported,
                                           Time now) {
  const RigidTransform T_WB = knowledge_.InPlane(T_WB_reported);
  if (mission_.homeward()) return Error{"the robot is on its way home"};
  if (mission_.HomeIsDue(map(), T_WB.translation(), now))
    return Error{"the rest of the budget is needed to get home"};
  // Boxes that the robot has yet to leave are not in the map.
  if (errand.kind == Errand::Kind::kGoTo && no_go_.ReachIntoLifted(map(), map().IndexOf(errand.p_W)))
    return Error{"the goal " + PointText(errand.p_W) + " lies in a no-go box"};
  // The plan being executed stays what it is.
  const Task task = task_;
  const Result<Plan> plan = Carry(errand, T_WB, now);
  task_ = task;
  return plan ? std::nullopt : std::optional(Error{plan.error()});
}

std::optional<Error> Explorer::SendHome(const RigidTransform& T_WB_reported) {
  if (mission_.homeward()) return std::nullopt;
  const RigidTransform T_WB = knowledge_.InPlane(T_WB_reported);
  if (!mission_.home_paths().home_W()) return Error{"the robot has not set out yet: it is at home"};
  if (no_go_.DrawnTouch(map(), *mission_.home_paths().home_W()))
    return Error{"a drawn no-go box covers the place where the robot set out"};
  if (!mission_.KnowsPathHome(map(), T_WB.translation())) return Error{"no known path leads home"};
  mission_.TurnHome({.outcome = Outcome::kOperator});
  return std::nullopt;
}

bool Explorer::AimsAtIgnored() const {
  const auto is_ignored = [&](const VoxelIndex& i) { return IsIgnored(memory(), i); };
  return std::ranges::any_of(after_turn_ ? after_turn_->target : task_.target, is_ignored);
}

std::optional<Error> Explorer::DrawNoGo(const Eigen::AlignedBox3d& box_W,
                                        const RigidTransform& T_WB_reported) {
  return explorer::DrawNoGo(box_W, knowledge_.InPlane(T_WB_reported).translation(), options_.robot.radius,
                            no_go_, mission_, knowledge_);
}

void Explorer::TakeOverFrom(const Explorer& other) {
  no_go_.TakeOverFrom(other.no_go_);
  asides_ = other.asides_;
  mission_ = other.mission_;
  mission_.ForgetPaths();
  plans_ = other.plans_;
  timings_ = other.timings_;
  options_.strategy = other.options_.strategy;
  strategy_ = options_.strategy.make();
  inspection_.Follow(*strategy_, knowledge_);
}

std::optional<Error> Explorer::UseStrategy(std::string_view name) try {
  ConfiguredStrategy strategy = options_.configure(name);
  strategy_ = strategy.make();
  options_.strategy = std::move(strategy);
  inspection_.Follow(*strategy_, knowledge_);
  return std::nullopt;
} catch (const std::invalid_argument& error) {
  return Error{error.what()};
}

Plan Explorer::LookForSpace(const RigidTransform& T_WB) {
  const std::optional<Eigen::Matrix3d> R_WB = blind_look_.Next(T_WB.linear(), options_.robot.level());
  if (!R_WB) return Done(Outcome::kNoFreeSpace);
  task_.DropTarget();
  Plan plan;
  plan.kind = Plan::Kind::kLook;
  plan.purpose = Purpose::kFindFreeSpace;
  plan.T_WBs = {MakeTransform(*R_WB, T_WB.translation())};
  return plan;
}

std::optional<Plan> Explorer::LookAround(const RigidTransform& T_WB) {
  const std::vector<Sighting> sightings = knowledge_.SightingsFromBody(T_WB.translation());
  std::vector<bool> fresh(sightings.size());
  for (std::size_t n = 0; n < sightings.size(); ++n) {
    const VoxelIndex& i = sightings[n].voxel;
    fresh[n] = memory().Looks(i) == 0 && memory().set_aside()[i] == 0;
  }
  const ViewPlanner& views = knowledge_.views();
  const View view = views.Best(sightings, fresh, {}, T_WB.linear());
  const std::size_t enough =
      has_left_start_ ? VoxelsOfArea(options_.look_around_min_area, map().voxel_size()) : 1;
  if (view.count < enough) return std::nullopt;
  std::vector<VoxelIndex> target;
  for (std::size_t n = 0; n < sightings.size(); ++n) {
    if (fresh[n] && views.Shows(view.R_WB, sightings[n])) target.push_back(sightings[n].voxel);
  }
  Plan plan;
  plan.kind = Plan::Kind::kLook;
  plan.purpose = Purpose::kLookAround;
  plan.T_WBs = {MakeTransform(view.R_WB, T_WB.translation())};
  plan.target_W = T_WB.translation() + view.R_WB.col(0);
  AimAt(std::move(target), plan);
  return plan;
}

void Explorer::AimAt(std::vector<VoxelIndex> target, Plan& plan) {
  task_.Aim(std::move(target), map());
  plan.target_doubtful = task_.doubtful_in_target();
  plan.target_unknown = task_.target.size() - plan.target_doubtful;
}

Plan Explorer::GoTo(const Choice& choice, const RigidTransform& T_WB) {
  const Candidate& candidate = search_.candidates()[choice.candidate];
  const std::vector<VoxelIndex>& target = choice.target.empty() ? candidate.cluster.unknowns : choice.target;
  std::vector<Eigen::Vector3d> path_W = choice.path_W;
  if (options_.loop.stop_short) {
    StopWhereSeen(map(), knowledge_.views(), options_.look_range, target, path_W);
  }
  const Stopwatch comfort;
  path_W = MakeComfortable(map(), path_W, options_.comfort);
  timings_["comfort"].Add(comfort.Milliseconds());
  const View view = BestViewOf(target, knowledge_.SightingsFromBody(path_W.back()), memory().set_aside(),
                               knowledge_.views(), T_WB.linear());
  Plan plan = Follow(path_W, view.R_WB, T_WB);
  plan.purpose = Purpose::kSeeFrontier;
  plan.target_W = candidate.cluster.center_W;
  plan.frontiers = search_.candidates().size();
  AimAt(target, plan);
  return plan;
}

Plan Explorer::Follow(const std::vector<Eigen::Vector3d>& path_W, const Eigen::Matrix3d& R_WB,
                      const RigidTransform& T_WB) {
  std::vector<Eigen::Vector3d> level_W = path_W;
  if (minimizes_time()) {
    std::vector<Eigen::Vector3d> whole_W;
    if (lead_) whole_W.emplace_back((lead_->T_WBs.end() - 2)->translation());
    whole_W.insert(whole_W.end(), level_W.begin(), level_W.end());
    level_W = MakeFlyable(map(), whole_W, clearance() + options_.comfort.distance, lead_.has_value());
  }
  if (map().plane()) {
    for (Eigen::Vector3d& p_W : level_W) p_W.z() = *map().plane();
  }
  task_.plan = {};
  task_.plan.kind = Plan::Kind::kGo;
  task_.plan.length = PathLength(path_W);
  task_.Follow(options_.loop.face_target
                   ? FaceNarrowPassages(
                         map(), level_W, T_WB, R_WB, options_.robot,
                         minimizes_time() ? AngleWellInView(options_.camera, options_.robot) : kOffThePath)
                   : FaceTravel(level_W, T_WB),
               map(), least_clearance());
  return task_.plan;
}

std::vector<FrontierReport> Explorer::frontier_reports() const {
  return ReportFrontiers(knowledge_, search_.candidates(), task_.choice);
}

Explorer::Standing Explorer::standing() const {
  return {.strategy = options_.strategy.name,
          .homeward = mission_.homeward().has_value(),
          .ignored = asides_.ignored(),
          .drawn_no_go = no_go_.drawn(),
          .in_no_go = no_go_.robot_inside()};
}

Explorer::Status Explorer::status() const {
  Status status;
  status.frontiers_left = search_.candidates().size();
  for (const Candidate& candidate : search_.candidates())
    status.frontier_voxels_left += candidate.cluster.unknowns.size();
  status.set_aside = CountSetAside(knowledge_, search_.frontiers());
  status.plans = plans_;
  status.distance = mission_.distance();
  for (const auto& [stage, timing] : timings_) status.timings[stage] = timing.Summarize();
  return status;
}

}  // namespace thalweg::explorer
