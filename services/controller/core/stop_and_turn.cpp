#include "services/controller/core/stop_and_turn.h"

#include <cmath>
#include <utility>

#include "common/geometry/polyline.h"
#include "services/controller/core/track.h"

namespace thalweg::controller {

StopAndTurn::StopAndTurn(const PathFollower::Options& options) : follower_(options) {}

void StopAndTurn::SetPath(Time id, std::vector<RigidTransform> T_WBs, Time now) {
  const bool is_known = path_ && path_->id == id && path_->T_WBs.empty() == T_WBs.empty();
  if (!is_known || went_back_) legs_.clear();
  went_back_ = false;
  path_ = Path{.id = id, .T_WBs = std::move(T_WBs), .heard = now};
  if (legs_.empty()) return;
  FollowLeg();
}

void StopAndTurn::SetPose(const RigidTransform& T_WB, Time stamp) {
  T_WB_ = T_WB;
  follower_.SetPose(T_WB, stamp);
}

Motion StopAndTurn::Step(Time now) {
  if (path_ && T_WB_ && legs_.empty()) MakeLegs();
  Motion motion = follower_.Step(now);
  if (!path_ || legs_.empty()) return motion;
  went_back_ =
      went_back_ || motion.reason == StopReason::kGoingBack || motion.reason == StopReason::kWentBack;
  while (motion.state == MotionState::kDone && leg_ + 1 < legs_.size()) {
    ++leg_;
    FollowLeg();
    motion = follower_.Step(now);
  }
  return Whole(std::move(motion));
}

/// A path that is too far away to be joined, or empty, is left to the follower as it is.
void StopAndTurn::MakeLegs() {
  leg_ = 0;
  const auto joined = JoinPath(T_WB_->translation(), path_->T_WBs, follower_.options().path_tolerance);
  if (!joined || joined->size() < 2) {
    legs_ = {{.T_WBs = path_->T_WBs, .length = PathLength(path_->T_WBs)}};
    return FollowLeg();
  }
  const bool faces_travel = follower_.options().robot.faces_travel();
  for (std::size_t n = 1; n < joined->size(); ++n) {
    const RigidTransform& from = (*joined)[n - 1];
    const RigidTransform to = EndOf(from, (*joined)[n], n + 1 == joined->size());
    // One that faces its way turns before each leg without being led to.
    if (!faces_travel) legs_.push_back({.T_WBs = {MakeTransform(to.linear(), from.translation())}});
    legs_.push_back({.T_WBs = {MakeTransform(to.linear(), from.translation()), to},
                     .length = (to.translation() - from.translation()).norm()});
  }
  FollowLeg();
}

/// Where a leg ends. Only at its last pose does a robot that faces its way turn away from there.
RigidTransform StopAndTurn::EndOf(const RigidTransform& from, const RigidTransform& to, bool is_last) const {
  const Eigen::Vector3d way_W = to.translation() - from.translation();
  if (is_last || !follower_.options().robot.faces_travel() || way_W.head<2>().norm() == 0.0) return to;
  return MakeTransform(RotationFromYawPitch(std::atan2(way_W.y(), way_W.x()), 0.0), to.translation());
}

/// The present leg as a path, heard when the whole path was. Its id differs from those of the legs before.
void StopAndTurn::FollowLeg() {
  follower_.SetPath(path_->id + Duration(leg_), legs_[leg_].T_WBs, path_->heard);
}

Motion StopAndTurn::Whole(Motion of_leg) const {
  of_leg.path_id = path_->id;
  for (std::size_t n = 0; n < legs_.size(); ++n) {
    if (n < leg_) of_leg.distance_done += legs_[n].length;
    if (n > leg_) of_leg.distance_left += legs_[n].length;
  }
  return of_leg;
}

}  // namespace thalweg::controller
