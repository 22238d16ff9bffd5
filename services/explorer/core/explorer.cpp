#include "services/explorer/core/explorer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/stage_names.h"
#include "common/base/stopwatch.h"
#include "common/geometry/attitude.h"
#include "common/geometry/point_text.h"
#include "services/explorer/core/aftermath.h"
#include "services/explorer/core/no_go_paths.h"
#include "services/explorer/core/turn_price.h"

namespace thalweg::explorer {
namespace {

constexpr double kSamePosition = 0.05;  // [m]
// A decision that took long makes those after it expect as much, each a little less.
constexpr double kFade = 0.9;
// [s] From odometry to here and from here to the controller, and what one decision takes longer than the
// last.
constexpr double kLate = 0.15;

/// The options as the rules and the robot's kind make them. Throws std::invalid_argument naming the invalid
/// option.
ExplorerOptions Checked(const ExplorerOptions& options) {
  Check(options);
  return WithLoopRules(ReachingBeyondItsFeet(options));
}

/// The turn toward the narrow passage that a task's path leads into.
Task TurnFirst(const Task& task) {
  Task turn;
  turn.plan = task.plan;
  turn.plan.kind = Plan::Kind::kLook;
  turn.plan.faces_passage_first = true;
  turn.plan.T_WBs = {task.plan.T_WBs.front()};
  turn.choice = task.choice;
  return turn;
}

}  // namespace

Explorer::Explorer(const Options& options)
    : options_(Checked(options)),
      knowledge_(KnowledgeOptions(options_)),
      mission_(MissionOptions(options_)),
      going_back_(options_),
      targets_(options_, knowledge_),
      errands_(options_),
      no_go_(NoGoOptions(options_)),
      decision_time_(options_.decision_time) {}

void Explorer::Reset() {
  knowledge_.Reset();
  targets_.Reset(knowledge_);
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

void Explorer::NoteDecisionTime(double seconds) {
  decision_time_ = std::max({options_.decision_time, seconds + kLate, kFade * decision_time_});
}

void Explorer::SaveTo(SavedExploration& saved, Time now) const {
  saved.home_W = mission_.home_paths().home_W();
  saved.distance = mission_.distance();
  saved.elapsed = mission_.Elapsed(now);
  saved.homeward = mission_.homeward();
  saved.gone_tight_way = targets_.gone_tight_way();
  saved.strategy = targets_.strategy_name();
  saved.drawn = no_go_.drawn();
  saved.aside.clear();
  asides_.SaveTo(saved.aside, knowledge_);
}

void Explorer::Restore(const SavedExploration& saved) {
  mission_.Restore(saved);
  for (const Eigen::AlignedBox3d& box_W : saved.drawn) no_go_.Draw(box_W);
  targets_.RestoreGoneTightWay(saved.gone_tight_way);
  UseStrategy(saved.strategy);  // one that is gone leaves the scenario's
  asides_.Restore(saved.aside);
}

void Explorer::ShiftTimes(Duration back) {
  mission_.ShiftTimes(back);
  updated_ -= back;
  knowledge_.memory().ShiftTimes(back);
  targets_.ShiftTimes(back);
  going_back_.ShiftTimes(back);
}

void Explorer::See(const CameraView& seen) {
  Strategy& strategy = targets_.strategy();
  if (strategy.goes_by_views() && strategy.lacks_view()) strategy.See(seen);
}

void Explorer::Arrived(Time now, const CameraView* seen) {
  // Whoever turned to a passage is still on the way.
  if (seen != nullptr && task_.plan.purpose == Purpose::kTakeView && !task_.plan.faces_passage_first)
    targets_.strategy().See(*seen);
  RememberArrival(task_, knowledge_, now);
  task_.DropTarget();
}

void Explorer::DidNotGetThere(Time now) {
  RememberFailure(task_, knowledge_, now);
  targets_.DidNotGetThere(task_, map());
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
  if (!task_.StillClear(map(), p_W, options_.least_clearance(), options_.robot.radius))
    return Interruption::kPathBlocked;
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
  if (!minimizes_time() || !(speed > 0.0) || !options_.robot.turns_on_the_spot()) return std::nullopt;
  const double a = options_.robot.max_acceleration;
  const double decides = DecidesWithin();
  const double then = SpeedIn(decides, speed);
  const double gaining = (then - speed) / a;
  const double brakes = then / a;
  return task_.DepartAhead(
      T_WB, {.length = 0.5 * (speed + then) * gaining + then * (decides - gaining), .time = decides},
      {.length = 0.5 * then * brakes, .time = 0.5 * brakes}, options_.robot);
}

double Explorer::DecidesWithin() const {
  // A robot whose motion is smoothed follows its path half of that time late.
  return decision_time_ + 0.5 * options_.robot.smoothing();
}

double Explorer::SpeedIn(double time, double speed) const {
  const RobotModel& robot = options_.robot;
  return std::max(speed, std::min(speed + robot.max_acceleration * time, robot.max_speed));
}

TaskMaker::Lead Explorer::LeadOf(const Task::Departure& departure, double speed) const {
  TaskMaker::Lead lead{.path = departure.lead, .hears = departure.hears, .flight = {}};
  // A robot that faces where it goes may not turn as fast as it could fly.
  if (lead.hears.pose + 1 == lead.path.T_WBs.size() || options_.robot.faces_travel()) return lead;
  const double a = options_.robot.max_acceleration;
  const Eigen::Vector3d p_W = lead.hears.T_WB.translation();
  const Eigen::Vector3d along_W = lead.path.T_WBs[lead.hears.pose + 1].translation() - p_W;
  lead.flight =
      Flight{.p_W = p_W,
             .v_W = std::min(SpeedIn(DecidesWithin(), speed), std::sqrt(2.0 * a * lead.hears.left)) *
                    along_W.normalized(),
             .max_speed = options_.robot.max_speed,
             .max_acceleration = a};
  return lead;
}

std::optional<std::vector<RigidTransform>> Explorer::PathUntilReplanned(const RigidTransform& T_WB,
                                                                        double speed) const {
  using Path = std::vector<RigidTransform>;
  if (!minimizes_time()) return std::nullopt;
  if (!(speed > 0.0)) return Path{};
  std::optional<Task::Departure> departure = DepartureOf(T_WB, speed);
  if (!departure) return std::nullopt;
  const Path& lead = departure->lead.T_WBs;
  for (std::size_t n = 1; n < lead.size(); ++n) {
    if (!map().SegmentClear(lead[n - 1].translation(), lead[n].translation(),
                            PlanningMap::Obstacles::kOccupied, options_.least_clearance()))
      return std::nullopt;
  }
  return std::move(departure->lead.T_WBs);
}

Plan Explorer::MakePlan(const RigidTransform& T_WB_reported, Time now, double speed) {
  const Stopwatch whole;
  const std::optional<Task::Departure> departure = DepartureOf(knowledge_.InPlane(T_WB_reported), speed);
  lead_ = departure ? std::optional(LeadOf(*departure, speed)) : std::nullopt;
  planned_in_flight_ = departure.has_value();
  const RigidTransform T_WB = BeginPlan(departure ? departure->T_WB : T_WB_reported, now);
  std::optional<Task> task = Duty(T_WB, now);
  if (!task) {
    task = Explore(T_WB, now);
    if (mission_.returns_home() && task->plan.ending) {
      mission_.TurnHome(*task->plan.ending);
      task = GoHome(T_WB, now);
    }
  }
  return FinishPlan(*std::move(task), whole.Milliseconds());
}

Result<Plan> Explorer::MakePlanFor(const Errand& errand, const RigidTransform& T_WB_reported, Time now) {
  const Stopwatch whole;
  lead_.reset();
  const RigidTransform T_WB = BeginPlan(T_WB_reported, now);
  std::optional<Task> task = Duty(T_WB, now);
  if (!task) {
    Result<Task> carried = errands_.MakeTask(errand, T_WB, now, maker(), mission_, knowledge_);
    if (!carried) {
      task_ = {};
      return Error{carried.error()};
    }
    task = *std::move(carried);
  }
  return FinishPlan(*std::move(task), whole.Milliseconds());
}

RigidTransform Explorer::BeginPlan(const RigidTransform& T_WB_reported, Time now) {
  RigidTransform T_WB = knowledge_.InPlane(T_WB_reported);
  ++plans_;
  knowledge_.memory().Expire(now);
  no_go_.PutUp(T_WB.translation(), knowledge_);
  mission_.FindPathsHome(map(), T_WB.translation());
  return T_WB;
}

std::optional<Task> Explorer::Duty(const RigidTransform& T_WB, Time now) {
  const Eigen::Vector3d p_W = T_WB.translation();
  if (const std::optional<Budget> spent = BudgetSpent(now)) return Ended(OutcomeOf(*spent));
  if (std::optional<Task> kept = ResumeAfterTurn(T_WB)) return kept;
  // A robot that has arrived at home stays there, even if a box was drawn around it meanwhile.
  if (mission_.homeward() && mission_.EndingAtHome(p_W)) return GoHome(T_WB, now);
  if (no_go_.robot_inside()) return LeaveNoGo(T_WB);
  if (!mission_.homeward()) {
    if (const auto budget = mission_.HomeIsDue(map(), p_W, now))
      mission_.TurnHome({.outcome = OutcomeOf(*budget)});
  }
  return mission_.homeward() ? std::optional(GoHome(T_WB, now)) : std::nullopt;
}

Task Explorer::Explore(const RigidTransform& T_WB, Time now) {
  if (!KnowsPlace(T_WB)) return LookForSpace(T_WB);
  blind_look_.Reset();
  // A robot that has not seen its surroundings may find nothing reachable.
  const bool left_to_strategy = targets_.strategy().goes_by_views() ||
                                (has_left_start_ && minimizes_time() && targets_.strategy().weighs_looks());
  // One that turns only in curves goes by the way, like to anything else.
  const bool turns = options_.robot.turns_on_the_spot();
  if (options_.loop.look_around && turns && !left_to_strategy && !lead_) {
    const std::size_t enough =
        has_left_start_ ? VoxelsOfArea(options_.look_around_min_area, map().voxel_size()) : 1;
    if (std::optional<Task> look = maker().LookAround(T_WB, enough)) return *std::move(look);
  }
  Task task = targets_.Choose(T_WB, now, maker(), mission_, knowledge_, going_back_, timings_);
  if (!task.plan.ending) has_left_start_ = true;
  return task;
}

Plan Explorer::FinishPlan(Task task, double milliseconds) {
  after_turn_.reset();
  if (options_.robot.gimballed()) {
    for (RigidTransform& T_WB : task.plan.T_WBs) T_WB = Held(options_.robot, T_WB);
  }
  task_ = std::move(task);
  if (task_.turn_first) {
    after_turn_ = task_;
    task_ = TurnFirst(task_);
  }
  if (lead_ && !task_.plan.ending) {
    // A path begins on the last segment of what leads to it, see TaskMaker::Follow.
    FacedPath& path = lead_->path;
    const bool on_path = task_.plan.kind == Plan::Kind::kGo || task_.plan.faces_passage_first;
    const std::size_t before = task_.lead_poses.value_or(path.T_WBs.size() - (on_path ? 1 : 0));
    path.T_WBs.erase(path.T_WBs.begin() + static_cast<std::ptrdiff_t>(before), path.T_WBs.end());
    path.narrow.resize(before);
    task_.Prepend(path, map(), options_.least_clearance());
  }
  lead_.reset();
  task_.plan.homeward = mission_.homeward();
  task_.plan.notes = targets_.strategy().TakeNotes();
  if (task_.plan.ending) task_.plan.ending->left_out = targets_.left_out();
  timings_[kPlanStage].Add(milliseconds);
  return task_.plan;
}

std::optional<Task> Explorer::ResumeAfterTurn(const RigidTransform& T_WB) {
  if (!after_turn_) return std::nullopt;
  task_ = *std::exchange(after_turn_, std::nullopt);
  task_.turn_first = false;
  const double off = (T_WB.translation() - task_.plan.T_WBs.front().translation()).norm();
  if (off > kSamePosition || CheckPlan(T_WB)) return std::nullopt;
  return task_;
}

Task Explorer::LookForSpace(const RigidTransform& T_WB) {
  const std::optional<Eigen::Matrix3d> R_WB = blind_look_.Next(T_WB.linear(), options_.robot);
  std::optional<Task> turn = R_WB ? maker().Turn(Purpose::kFindFreeSpace, *R_WB, T_WB) : std::nullopt;
  return turn ? *std::move(turn) : Ended(Outcome::kNoFreeSpace);
}

Task Explorer::GoHome(const RigidTransform& T_WB, Time now) {
  const Eigen::Vector3d p_W = T_WB.translation();
  if (std::optional<Ending> ending = mission_.EndingAtHome(p_W)) return Ended(*std::move(ending));
  const std::vector<Eigen::Vector3d> path_W = mission_.home_paths().PathFrom(map(), p_W);
  std::optional<Task> task;
  if (path_W.empty()) {
    task = going_back_.ToPathHome(T_WB, now, map(), mission_.home_paths(), maker());
  } else {
    going_back_.GoesOn();
    task = maker().Follow(Purpose::kGoHome, maker().Smoothed(path_W), T_WB.linear(), T_WB);
    if (task) task->plan.target_W = *mission_.home_paths().home_W();
  }
  return task ? *std::move(task) : Ended(Outcome::kNoPathHome);
}

Task Explorer::LeaveNoGo(const RigidTransform& T_WB) {
  const std::vector<Eigen::Vector3d> path_W = PathOutOfNoGo(T_WB.translation(), no_go_, mission_, knowledge_);
  if (path_W.empty()) return Ended(Outcome::kNothingReachable);
  std::optional<Task> task = maker().Follow(
      Purpose::kLeaveNoGo, PullStraight(map(), path_W, options_.clearance()), T_WB.linear(), T_WB);
  if (!task) return Ended(Outcome::kNothingReachable);
  task->plan.target_W = path_W.back();
  return *std::move(task);
}

void Explorer::Abandon() {
  after_turn_.reset();
  going_back_.GoesOn();
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
  const Result<Task> task = errands_.MakeTask(errand, T_WB, now, maker(), mission_, knowledge_);
  return task ? std::nullopt : std::optional(Error{task.error()});
}

std::optional<Error> Explorer::SendHome(const RigidTransform& T_WB_reported) {
  if (mission_.homeward()) return std::nullopt;
  const RigidTransform T_WB = knowledge_.InPlane(T_WB_reported);
  if (!mission_.home_paths().home_W()) return Error{"the robot has not set out yet: it is at home"};
  if (no_go_.DrawnTouch(map(), *mission_.home_paths().home_W()))
    return Error{"a drawn no-go box covers the place where the robot set out"};
  if (!mission_.KnowsPathHome(map(), T_WB.translation()) &&
      !going_back_.LeadsToPathHome(T_WB, map(), mission_.home_paths()))
    return Error{"no known path leads home"};
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
  decision_time_ = other.decision_time_;
  no_go_.TakeOverFrom(other.no_go_);
  asides_ = other.asides_;
  mission_ = other.mission_;
  mission_.ForgetPaths();
  going_back_ = other.going_back_;
  plans_ = other.plans_;
  timings_ = other.timings_;
  targets_.TakeOverFrom(other.targets_, knowledge_);
}

std::vector<FrontierReport> Explorer::frontier_reports() const {
  return ReportFrontiers(knowledge_, targets_.search().candidates(), task_.choice);
}

Explorer::Standing Explorer::standing() const {
  return {.strategy = targets_.strategy_name(),
          .homeward = mission_.homeward().has_value(),
          .gone_tight_way = targets_.gone_tight_way(),
          .ignored = asides_.ignored(),
          .drawn_no_go = no_go_.drawn(),
          .in_no_go = no_go_.robot_inside()};
}

Explorer::Status Explorer::status() const {
  Status status;
  const CandidateSearch& search = targets_.search();
  status.frontiers_left = search.candidates().size();
  for (const Candidate& candidate : search.candidates())
    status.frontier_voxels_left += candidate.cluster.unknowns.size();
  status.set_aside = CountSetAside(knowledge_, search.frontiers());
  status.plans = plans_;
  status.left_out = targets_.left_out();
  status.distance = mission_.distance();
  for (const auto& [stage, timing] : timings_) status.timings[stage] = timing.Summarize();
  return status;
}

}  // namespace thalweg::explorer
