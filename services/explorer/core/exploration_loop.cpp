#include "services/explorer/core/exploration_loop.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "common/base/size_text.h"
#include "common/base/text.h"
#include "common/geometry/plausible.h"
#include "common/geometry/point_text.h"

namespace thalweg::explorer {
namespace {

/// A controller that stopped may resume by itself when what it missed comes back, but not after this time.
constexpr Duration kPatience = std::chrono::seconds(3);

}  // namespace

ExplorationLoop::ExplorationLoop(const Explorer::Options& options) : options_(options), explorer_(options) {}

std::optional<Error> ExplorationLoop::OnMap(const MapNews& news, Time now) {
  FollowClock(now);
  if (news.replaced) {
    if (news.voxel_size != options_.voxel_size) {
      Explorer::Options options = options_;
      options.voxel_size = news.voxel_size;
      try {
        Explorer explorer(options);
        explorer.TakeOverFrom(explorer_);
        explorer_ = std::move(explorer);
      } catch (const std::invalid_argument& error) {
        return Error{"map of " + NumberText(news.voxel_size) + " m voxels: " + error.what()};
      }
      options_ = options;
    }
    explorer_.Reset();
    explorer_.Update(news.changes, {}, now);
    has_map_ = true;
    has_scan_ = false;
    if (phase_ == Phase::kExecuting || phase_ == Phase::kSettling) Count(Interruption::kMapReplaced);
    if (phase_ != Phase::kDone) plan_due_ = true;
    return std::nullopt;
  }
  if (!has_map_) return std::nullopt;
  explorer_.Update(news.changes, news.scans, now);
  has_scan_ = has_scan_ || !news.scans.empty();
  if (!news.scans.empty()) pace_.Note(now);
  if (phase_ == Phase::kExecuting && T_WB_) {
    const std::optional<Interruption> why = explorer_.CheckPlan(*T_WB_);
    if (const auto goes_on = why ? GoesOnAfter(*why) : std::nullopt) {
      Count(*why);
      // The decision may take longer than expected.
      if (*why == Interruption::kPathBlocked) Send(*goes_on, now);
      plan_due_ = true;
    } else if (why) {
      Interrupt(*why, now);
    }
  } else if (phase_ == Phase::kSettling && !news.scans.empty() && news.stamp >= arrived_at_ + plan_.dwell) {
    arrived_ = true;
    plan_due_ = true;
  }
  return std::nullopt;
}

void ExplorationLoop::OnPose(const RigidTransform& T_WB) {
  T_WB_ = T_WB;
  explorer_.Move(T_WB);
}

std::optional<Error> ExplorationLoop::OnView(ViewNews news) {
  if (!explorer_.AwaitsView()) return std::nullopt;
  const auto& [cloud, camera, T_WB, T_BC] = news.view;
  if (cloud.width_px != camera.width_px || cloud.height_px != camera.height_px ||
      cloud.points_C.size() !=
          static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px))
    return Error{"a cloud of " + SizeText(cloud.width_px, cloud.height_px) + " for a camera of " +
                 SizeText(camera.width_px, camera.height_px)};
  if (std::optional<std::string> mistake = MistakeIn(camera)) return Error{*std::move(mistake)};
  if (!IsPose(T_WB * T_BC)) return Error{"the pose is not a position and a rotation"};
  view_ = std::move(news);
  return std::nullopt;
}

bool ExplorationLoop::LacksView() const {
  return !errand_ && explorer_.AwaitsView() && ViewFromHere() == nullptr;
}

const CameraView* ExplorationLoop::ViewFromHere() const {
  return view_ && view_->stamp >= arrived_at_ ? &view_->view : nullptr;
}

void ExplorationLoop::FollowClock(Time now) {
  const Duration back = now_ - now;
  if (back > Duration::zero() && back < kClockRestart) return;
  now_ = now;
  if (back <= Duration::zero()) return;
  explorer_.ShiftTimes(back);
  sent_at_ -= back;
  pace_.ShiftTimes(back);
  view_.reset();
  arrived_at_ -= back;
  if (phase_ == Phase::kExecuting || phase_ == Phase::kSettling) Interrupt(Interruption::kClockReset, now);
}

void ExplorationLoop::OnMotion(const MotionNews& news, Time now) {
  FollowClock(now);
  speed_ = news.standing || news.done ? 0.0 : news.speed;
  if (phase_ == Phase::kStopping) {
    // A controller that restarted meanwhile stands still but may not know the id of the stop order.
    if (news.standing && (news.path_id == order_->id || now - sent_at_ > kPatience)) plan_due_ = true;
    return;
  }
  if (phase_ != Phase::kExecuting || !order_ || news.path_id != order_->id) return;
  if (news.done) {
    if (plan_due_) return;  // at the end of what was left of a blocked path
    phase_ = Phase::kSettling;
    arrived_at_ = news.stamp;
  } else if (!news.stopped) {
    stopped_since_.reset();
  } else if (lost_) {
    return;  // without a pose nothing can be planned
  } else if (!stopped_since_) {
    stopped_since_ = now;
  } else if (now - *stopped_since_ > kPatience && !plan_due_) {
    Count(Interruption::kControllerStopped);
    if (news.blocked) explorer_.DidNotGetThere(now);
    plan_due_ = true;
  }
}

void ExplorationLoop::OnTracking(bool lost, Time now) {
  FollowClock(now);
  if (std::exchange(lost_, lost) == lost) return;
  stopped_since_.reset();
  if (lost || (phase_ != Phase::kExecuting && phase_ != Phase::kSettling)) return;
  explorer_.DidNotGetThere(now);
  Interrupt(Interruption::kLost, now);
}

void ExplorationLoop::Count(Interruption why) {
  ++interruptions_[why];
  last_interruption_ = why;
}

std::size_t ExplorationLoop::replans() const {
  std::size_t unsafe = 0;
  for (const auto& [why, count] : interruptions_) unsafe += IsUnsafe(why) ? count : 0;
  return unsafe;
}

std::optional<std::vector<RigidTransform>> ExplorationLoop::GoesOnAfter(Interruption why) const {
  if (why == Interruption::kNotFacingPassage || errand_) return std::nullopt;
  return explorer_.PathUntilReplanned(*T_WB_, speed_);
}

void ExplorationLoop::Interrupt(Interruption why, Time now) {
  Count(why);
  phase_ = Phase::kStopping;
  state_ = LoopState::kPlanning;
  Send({}, now);
}

void ExplorationLoop::Send(std::vector<RigidTransform> T_WBs, Time now) {
  const Time id = order_ ? std::max(now, order_->id + Duration(1)) : now;
  order_ = Order{id, std::move(T_WBs)};
  sent_at_ = now;
  stopped_since_.reset();
  changed_ = true;
}

bool ExplorationLoop::ReadyToPlan() const {
  // Without a scan the map may have only just begun: what is unknown now may be known in a moment.
  return has_scan_ || explorer_.KnowsPlace(*T_WB_);
}

SavedExploration ExplorationLoop::Save(Time now) const {
  SavedExploration saved;
  explorer_.SaveTo(saved, now);
  // An errand is dropped: the robot waits where it is rather than going on by itself.
  if (phase_ == Phase::kDone) {
    saved.paused = PauseCause{PauseReason::kEnded};
  } else if (mode_ == Mode::kPaused) {
    saved.paused = pause_cause_;
  } else if (mode_ != Mode::kExploring) {
    saved.paused = PauseCause{PauseReason::kRestarted};
  }
  return saved;
}

void ExplorationLoop::Restore(const SavedExploration& saved) {
  explorer_.Restore(saved);
  if (!saved.paused) return;
  mode_ = Mode::kPaused;
  pause_cause_ = *saved.paused;
}

bool ExplorationLoop::Think(Time now) {
  FollowClock(now);
  if (phase_ != Phase::kDone && has_map_ && T_WB_) {
    const bool blind = Blind(now);
    if (blind && phase_ == Phase::kExecuting && plan_.kind == Plan::Kind::kGo && !lost_)
      Interrupt(Interruption::kMapSilent, now);
    const bool due = plan_due_ || phase_ == Phase::kWaiting;
    if (explorer_.BudgetSpent(now) || (due && ReadyToPlan() && !LacksView() && !Pauses(now) && !blind))
      MakePlan(now);
  }
  return std::exchange(changed_, false);
}

bool ExplorationLoop::Blind(Time now) const {
  return options_.loop.scan_on_the_way && pace_.Silent(now);
}

Awaited ExplorationLoop::awaited() const {
  if (phase_ != Phase::kWaiting) {
    const bool waits = phase_ != Phase::kDone && !lost_ && Blind(now_);
    if (waits) return Awaited::kNextScan;
    const bool stands = phase_ != Phase::kDone && !lost_ && mode_ != Mode::kPaused && plan_due_;
    return stands && LacksView() ? Awaited::kView : Awaited::kNothing;
  }
  if (!has_map_) return Awaited::kMap;
  if (!T_WB_) return Awaited::kOdometry;
  return ReadyToPlan() && LacksView() ? Awaited::kView : Awaited::kScan;
}

void ExplorationLoop::MakePlan(Time now) {
  NoteArrival(now);
  if (const CameraView* const seen = ViewFromHere()) explorer_.See(*seen);
  plan_due_ = false;
  decided_ = true;
  if (errand_) {
    const Result<Plan> plan = explorer_.MakePlanFor(*errand_, *T_WB_, now);
    if (!plan) {
      plan_due_ = true;
      return Pause({PauseReason::kErrandImpossible, plan.error()}, now);
    }
    plan_ = *plan;
  } else {
    plan_ = explorer_.MakePlan(*T_WB_, now, phase_ == Phase::kExecuting ? speed_ : 0.0);
  }
  if (plan_.kind == Plan::Kind::kDone) return End(now);
  phase_ = Phase::kExecuting;
  state_ = plan_.kind == Plan::Kind::kLook ? LoopState::kLooking : LoopState::kMoving;
  Send(plan_.T_WBs, now);
}

void ExplorationLoop::End(Time now) {
  phase_ = Phase::kDone;
  state_ = LoopState::kDone;
  Send({}, now);
}

LoopState ExplorationLoop::state() const {
  return mode_ == Mode::kPaused && phase_ != Phase::kDone ? LoopState::kPaused : state_;
}

void ExplorationLoop::Pause(PauseCause cause, Time now) {
  mode_ = Mode::kPaused;
  errand_.reset();
  pause_cause_ = std::move(cause);
  changed_ = true;
  if (phase_ != Phase::kExecuting) return;  // the robot stands, or has been stopped
  phase_ = Phase::kStopping;
  Send({}, now);
}

bool ExplorationLoop::Pauses(Time now) {
  const bool carried_out = arrived_ && !plan_.faces_passage_first;
  const bool on_errand = plan_.purpose == Purpose::kGoTo || plan_.purpose == Purpose::kLookAt;
  switch (mode_) {
    case Mode::kExploring:
      return false;
    case Mode::kStepping:
      if (!decided_ || (arrived_ && plan_.faces_passage_first)) return false;
      Pause({arrived_ ? PauseReason::kStepDone : PauseReason::kStepInterrupted}, now);
      break;
    case Mode::kErrand:
      if (!decided_ || !carried_out || !on_errand) return false;
      Pause({PauseReason::kErrandDone}, now);
      break;
    case Mode::kPaused:
      break;
  }
  NoteArrival(now);
  return true;
}

void ExplorationLoop::NoteArrival(Time now) {
  if (std::exchange(arrived_, false)) explorer_.Arrived(now, ViewFromHere());
}

void ExplorationLoop::Redirect(Time now) {
  plan_due_ = plan_due_ && phase_ != Phase::kExecuting;
  if (phase_ == Phase::kExecuting) Interrupt(Interruption::kOperator, now);
  explorer_.Abandon();
}

std::string ExplorationLoop::WhyNotMovable() const {
  if (!has_map_ || !T_WB_) return "there is no map or no pose yet";
  if (lost_) return "the robot is lost";
  return ReadyToPlan() ? "" : "the map knows no free space around the robot yet";
}

Answer ExplorationLoop::Obey(const Command& command, Time now) {
  FollowClock(now);
  if (phase_ == Phase::kDone) return {false, "the exploration has ended", *plan_.ending};
  return std::visit([&](const auto& known) { return Carry(known, now); }, command);
}

Answer ExplorationLoop::Carry(const command::Pause& /*pause*/, Time now) {
  if (mode_ == Mode::kPaused) return {true, "paused already"};
  Redirect(now);
  Pause({PauseReason::kOperator}, now);
  return {true, "paused: the robot stops and waits"};
}

Answer ExplorationLoop::Carry(const command::Resume& /*resume*/, Time now) {
  if (mode_ == Mode::kExploring) return {false, "nothing to resume: the robot is not paused"};
  if (mode_ == Mode::kErrand) {
    if (decided_) Redirect(now);
    errand_.reset();
  }
  mode_ = Mode::kExploring;
  changed_ = true;
  return {true, "exploring"};
}

Answer ExplorationLoop::Carry(const command::Step& /*step*/, Time now) {
  if (mode_ == Mode::kErrand) {
    if (decided_) Redirect(now);
    errand_.reset();
  }
  // A robot that carries out a decision finishes it.
  const bool active = mode_ == Mode::kExploring || mode_ == Mode::kStepping;
  decided_ = active && (phase_ == Phase::kExecuting || phase_ == Phase::kSettling);
  mode_ = Mode::kStepping;
  changed_ = true;
  return {true, decided_ ? "pauses when the present decision has been carried out"
                         : "makes one decision, carries it out and pauses"};
}

Answer ExplorationLoop::Carry(const command::Stop& /*stop*/, Time now) {
  plan_ = {};
  plan_.ending = Ending{.outcome = Outcome::kOperator};
  End(now);
  return {true, "the exploration ends here"};
}

Answer ExplorationLoop::Carry(const command::GoHome& /*home*/, Time now) {
  if (explorer_.standing().homeward && mode_ == Mode::kExploring) return {true, "on the way home already"};
  if (const std::string why = WhyNotMovable(); !why.empty()) return {false, why};
  if (const std::optional<Error> error = explorer_.SendHome(*T_WB_)) return {false, error->text};
  mode_ = Mode::kExploring;
  errand_.reset();
  Redirect(now);
  changed_ = true;
  return {true, "going home, where the exploration ends"};
}

Answer ExplorationLoop::Carry(const command::Run& run, Time now) {
  if (const std::string why = WhyNotMovable(); !why.empty()) return {false, why};
  if (const std::optional<Error> error = explorer_.CheckErrand(run.errand, *T_WB_, now))
    return {false, error->text};
  errand_ = run.errand;
  mode_ = Mode::kErrand;
  decided_ = false;
  Redirect(now);
  changed_ = true;
  const bool goes = errand_->kind == Errand::Kind::kGoTo;
  return {true, (goes ? "going to " : "looking at ") + PointText(errand_->p_W) +
                    ", where the robot then waits for resume"};
}

Answer ExplorationLoop::Carry(const command::Ignore& ignore, Time now) {
  const Result<Cluster> ignored = explorer_.Ignore(ignore.p_W, now);
  if (!ignored) return {false, ignored.error()};
  if (phase_ == Phase::kExecuting && explorer_.AimsAtIgnored()) Redirect(now);
  changed_ = true;
  return {true, "ignoring the frontier at " + PointText(ignored->center_W) + ", " +
                    std::to_string(ignored->unknowns.size()) + " voxels"};
}

Answer ExplorationLoop::Carry(const command::DrawNoGo& draw, Time now) {
  if (!has_map_ || !T_WB_) return {false, "there is no map or no pose yet"};
  if (const std::optional<Error> error = explorer_.DrawNoGo(draw.box_W, *T_WB_)) return {false, error->text};
  changed_ = true;
  const std::size_t boxes = explorer_.standing().drawn_no_go.size();
  std::string text =
      std::to_string(boxes) + (boxes == 1 ? " drawn no-go box" : " drawn no-go boxes") + " in force";
  if (explorer_.standing().in_no_go) {
    text += mode_ == Mode::kPaused ? "; the robot stands in it and leaves it when it resumes"
                                   : "; the robot stands in it and leaves it";
    Redirect(now);
  } else if (phase_ == Phase::kExecuting) {
    if (const std::optional<Interruption> why = explorer_.CheckPlan(*T_WB_)) Interrupt(*why, now);
  }
  return {true, std::move(text)};
}

Answer ExplorationLoop::Carry(const command::ClearNoGo& /*clear*/, Time /*now*/) {
  const std::size_t drawn = explorer_.standing().drawn_no_go.size();
  if (drawn == 0) return {false, "there is no drawn no-go box; those of the scenario stay"};
  explorer_.ClearDrawnNoGo();
  changed_ = true;
  return {true,
          std::to_string(drawn) + (drawn == 1 ? " drawn no-go box removed" : " drawn no-go boxes removed")};
}

Answer ExplorationLoop::Carry(const command::UseStrategy& use, Time /*now*/) {
  if (const std::optional<Error> error = explorer_.UseStrategy(use.name)) return {false, error->text};
  changed_ = true;
  return {true, "choosing by " + use.name + " from the next decision on"};
}

}  // namespace thalweg::explorer
