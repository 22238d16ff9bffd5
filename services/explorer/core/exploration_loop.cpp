#include "services/explorer/core/exploration_loop.h"

#include <algorithm>
#include <utility>

namespace thalweg::explorer {
namespace {

/// A controller that has stopped may go on by itself when what it missed comes back; not so after that.
constexpr Duration kPatience = std::chrono::seconds(3);

}  // namespace

ExplorationLoop::ExplorationLoop(const Explorer::Options& options) : options_(options), explorer_(options) {}

void ExplorationLoop::OnMap(const MapNews& news, Time now) {
  if (news.replaced) {
    if (news.voxel_size != options_.voxel_size) {
      options_.voxel_size = news.voxel_size;
      explorer_ = Explorer(options_);
    }
    explorer_.Reset();
    explorer_.Update(news.changes, {}, now);
    has_map_ = true;
    if (phase_ != Phase::kDone) plan_due_ = true;  // from a map that may be quite another
    return;
  }
  if (!has_map_) return;
  explorer_.Update(news.changes, news.T_WCs, now);
  if (phase_ == Phase::kExecuting && T_WB_) {
    if (const std::optional<Explorer::Interruption> why = explorer_.CheckPlan(*T_WB_)) Interrupt(*why, now);
  } else if (phase_ == Phase::kSettling && !news.T_WCs.empty() && news.stamp >= arrived_at_) {
    arrived_ = true;
    plan_due_ = true;
  }
}

void ExplorationLoop::OnPose(const RigidTransform& T_WB) {
  T_WB_ = T_WB;
  explorer_.Move(T_WB);
}

void ExplorationLoop::OnMotion(const MotionNews& news, Time now) {
  if (phase_ == Phase::kStopping) {
    // A controller that was restarted meanwhile stands, and may not name the order to stop.
    if (news.standing && (news.path_id == order_->id || now - order_->id > kPatience)) plan_due_ = true;
    return;
  }
  if (phase_ != Phase::kExecuting || !order_ || news.path_id != order_->id) return;
  if (news.done) {
    phase_ = Phase::kSettling;
    arrived_at_ = news.stamp;
  } else if (!news.stopped) {
    stopped_since_.reset();
  } else if (!stopped_since_) {
    stopped_since_ = now;
  } else if (now - *stopped_since_ > kPatience) {
    plan_due_ = true;
  }
}

void ExplorationLoop::Interrupt(const Explorer::Interruption& why, Time now) {
  if (why.unsafe) ++replans_;
  phase_ = Phase::kStopping;
  state_ = LoopState::kPlanning;
  Send({}, now);
}

void ExplorationLoop::Send(std::vector<RigidTransform> T_WBs, Time now) {
  const Time id = order_ ? std::max(now, order_->id + Duration(1)) : now;
  order_ = Order{id, std::move(T_WBs)};
  stopped_since_.reset();
  changed_ = true;
}

bool ExplorationLoop::Think(Time now) {
  if (phase_ == Phase::kWaiting) plan_due_ = true;
  if (plan_due_ && phase_ != Phase::kDone && has_map_ && T_WB_ && explorer_.KnowsPlace(*T_WB_)) MakePlan(now);
  return std::exchange(changed_, false);
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
