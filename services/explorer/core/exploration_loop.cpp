#include "services/explorer/core/exploration_loop.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

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
        explorer_ = Explorer(options);
      } catch (const std::invalid_argument& error) {
        return Error{"map of " + std::to_string(news.voxel_size) + " m voxels: " + error.what()};
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
  if (phase_ == Phase::kExecuting && T_WB_) {
    if (const std::optional<Interruption> why = explorer_.CheckPlan(*T_WB_)) Interrupt(*why, now);
  } else if (phase_ == Phase::kSettling && !news.scans.empty() && news.stamp >= arrived_at_) {
    arrived_ = true;
    plan_due_ = true;
  }
  return std::nullopt;
}

void ExplorationLoop::OnPose(const RigidTransform& T_WB) {
  T_WB_ = T_WB;
  explorer_.Move(T_WB);
}

void ExplorationLoop::FollowClock(Time now) {
  const Duration back = now_ - now;
  if (back > Duration::zero() && back < kClockBeganAnew) return;
  now_ = now;
  if (back <= Duration::zero()) return;
  explorer_.ShiftTimes(back);
  sent_at_ -= back;
  if (phase_ == Phase::kExecuting || phase_ == Phase::kSettling) Interrupt(Interruption::kClockReset, now);
}

void ExplorationLoop::OnMotion(const MotionNews& news, Time now) {
  FollowClock(now);
  if (phase_ == Phase::kStopping) {
    // A controller that restarted meanwhile stands still but may not know the id of the stop order.
    if (news.standing && (news.path_id == order_->id || now - sent_at_ > kPatience)) plan_due_ = true;
    return;
  }
  if (phase_ != Phase::kExecuting || !order_ || news.path_id != order_->id) return;
  if (news.done) {
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
    plan_due_ = true;
  }
}

void ExplorationLoop::OnTracking(bool lost, Time now) {
  FollowClock(now);
  if (std::exchange(lost_, lost) == lost) return;
  stopped_since_.reset();
  if (lost || (phase_ != Phase::kExecuting && phase_ != Phase::kSettling)) return;
  explorer_.GotLost(now);
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

bool ExplorationLoop::Think(Time now) {
  FollowClock(now);
  if (phase_ != Phase::kDone && has_map_ && T_WB_) {
    const bool due = plan_due_ || phase_ == Phase::kWaiting;
    if (explorer_.BudgetSpent(now) || (due && ReadyToPlan())) MakePlan(now);
  }
  return std::exchange(changed_, false);
}

Awaited ExplorationLoop::awaited() const {
  if (phase_ != Phase::kWaiting) return Awaited::kNothing;
  if (!has_map_) return Awaited::kMap;
  return T_WB_ ? Awaited::kScan : Awaited::kOdometry;
}

void ExplorationLoop::MakePlan(Time now) {
  if (std::exchange(arrived_, false)) explorer_.Arrived(now);
  plan_due_ = false;
  plan_ = explorer_.MakePlan(*T_WB_, now);
  if (plan_.kind == Plan::Kind::kDone) {
    phase_ = Phase::kDone;
    state_ = LoopState::kDone;
    Send({}, now);
    return;
  }
  phase_ = Phase::kExecuting;
  state_ = plan_.kind == Plan::Kind::kLook ? LoopState::kLooking : LoopState::kMoving;
  Send(plan_.T_WBs, now);
}

}  // namespace thalweg::explorer
