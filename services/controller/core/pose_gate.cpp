#include "services/controller/core/pose_gate.h"

#include <algorithm>

namespace thalweg::controller {

bool PoseGate::CanFollow(const Pose& from, const Pose& to) const {
  const double apart = Seconds(to.stamp - from.stamp);
  if (apart < 0.0) return true;  // the clock was reset
  // A stamp far ahead must not excuse any jump; whatever has moved farther is believed if it stays there.
  const double dt = std::min(apart, options_.persistence);
  const double moved = (to.T_WB.translation() - from.T_WB.translation()).norm();
  return moved <= options_.slack + options_.factor * options_.max_speed * dt &&
         AngleBetween(from.T_WB, to.T_WB) <=
             options_.turn_slack + options_.factor * options_.max_turn_rate * dt;
}

std::optional<PoseGate::Jump> PoseGate::Refuse(const RigidTransform& T_WB, Time stamp) {
  const Pose pose{T_WB, stamp};
  const bool follows = !last_ || CanFollow(*last_, pose);
  if (!follows) {
    if (!elsewhere_ || !CanFollow(*elsewhere_, pose)) jumped_at_ = stamp;
    elsewhere_ = pose;
  }
  if (follows || Seconds(stamp - *jumped_at_) >= options_.persistence) {
    last_ = pose;
    elsewhere_.reset();
    jumped_at_.reset();
    return std::nullopt;
  }
  return Jump{.distance = (T_WB.translation() - last_->T_WB.translation()).norm(),
              .turn = AngleBetween(last_->T_WB, T_WB),
              .time = Seconds(stamp - last_->stamp)};
}

}  // namespace thalweg::controller
