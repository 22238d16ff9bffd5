#include "services/controller/core/stop_and_turn.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "common/geometry/polyline.h"
#include "services/controller/core/track.h"

namespace thalweg::controller {
namespace {

/// Whether the robot may be elsewhere than where its legs began, once that is over.
bool LosesPose(StopReason reason) {
  return reason == StopReason::kLost || reason == StopReason::kRetreating ||
         reason == StopReason::kPoseSilent;
}

}  // namespace

StopAndTurn::StopAndTurn(const PathFollower::Options& options) : follower_(options) {
  if (!options.robot.turns_on_the_spot())
    throw std::invalid_argument("drive: a robot that cannot turn on the spot cannot stop and turn");
}

void StopAndTurn::SetPath(Time id, std::vector<RigidTransform> T_WBs, Time now) {
  const bool is_known = path_ && path_->id == id && path_->T_WBs.empty() == T_WBs.empty();
  const bool went_back = last_reason_ == StopReason::kGoingBack || last_reason_ == StopReason::kWentBack;
  const double length = PathLength(T_WBs);
  path_ = Path{.id = id, .T_WBs = std::move(T_WBs), .length = length, .heard = now};
  if (!is_known || went_back) return HoldStill();
  follower_.SetPath(Time{} + Duration(hand_overs_), handed_over_, now);
}

void StopAndTurn::SetPose(const RigidTransform& T_WB, Time stamp) {
  T_WB_ = T_WB;
  follower_.SetPose(T_WB, stamp);
}

Motion StopAndTurn::Step(Time now) {
  if (path_) path_->heard = std::min(path_->heard, now);  // if the clock was reset
  Motion motion = follower_.Step(now);
  if (!path_) return motion;
  const bool may_be_elsewhere = LosesPose(last_reason_) && !LosesPose(motion.reason);
  if (!legs_.empty() && (may_be_elsewhere || motion.reason == StopReason::kOffPath)) {
    HoldStill();
    motion = follower_.Step(now);
  }
  while (AdvanceFrom(motion)) motion = follower_.Step(now);
  last_reason_ = motion.reason;
  return Whole(std::move(motion));
}

/// Hands over the next turn or leg, if it is time.
bool StopAndTurn::AdvanceFrom(const Motion& motion) {
  if (legs_.empty()) {
    if (motion.reason != StopReason::kEmptyPath || !follower_.standing() || !MakeLegs(motion)) return false;
    leg_ = 0;
  } else {
    if (motion.state != MotionState::kDone || leg_ + 1 == legs_.size()) return false;
    ++leg_;
  }
  HandOver(legs_[leg_].T_WBs);
  return true;
}

/// Divides the path, from where the robot stands on, into turns and legs. Returns false if there is none, or
/// it is too far away.
bool StopAndTurn::MakeLegs(const Motion& motion) {
  if (path_->T_WBs.empty() || !T_WB_) return false;
  const PathFollower::Options& options = follower_.options();
  // The follower goes on from its command, too, unless the robot is elsewhere.
  Eigen::Vector3d start_W = T_WB_->translation();
  if (motion.command) {
    const RigidTransform& command = motion.command->T_WB;
    const bool is_there = (command.translation() - start_W).norm() <= options.position_tolerance &&
                          AngleBetween(command, *T_WB_) <= options.angle_tolerance;
    if (is_there) start_W = command.translation();
  }
  const auto joined = JoinPath(start_W, path_->T_WBs, options.path_tolerance);
  if (!joined) return false;
  const bool faces_travel = options.robot.faces_travel();
  for (std::size_t n = 1; n < joined->size(); ++n) {
    const RigidTransform& from = (*joined)[n - 1];
    const RigidTransform to = EndOf(from, (*joined)[n], n + 1 == joined->size());
    const RigidTransform turned = MakeTransform(to.linear(), from.translation());
    // One that faces its way turns before each leg without being led to.
    if (!faces_travel) legs_.push_back({.T_WBs = {turned}});
    legs_.push_back({.T_WBs = {turned, to}, .length = (to.translation() - from.translation()).norm()});
  }
  return true;
}

/// Where a leg ends. Only at its last pose does a robot that faces its way turn away from there.
RigidTransform StopAndTurn::EndOf(const RigidTransform& from, const RigidTransform& to, bool is_last) const {
  const Eigen::Vector3d way_W = to.translation() - from.translation();
  if (is_last || !follower_.options().robot.faces_travel() || way_W.head<2>().norm() == 0.0) return to;
  return MakeTransform(RotationFromYawPitch(std::atan2(way_W.y(), way_W.x()), 0.0), to.translation());
}

void StopAndTurn::HoldStill() {
  legs_.clear();
  HandOver({});
}

/// The follower hears of it when the whole path was heard.
void StopAndTurn::HandOver(std::vector<RigidTransform> T_WBs) {
  ++hand_overs_;
  handed_over_ = std::move(T_WBs);
  follower_.SetPath(Time{} + Duration(hand_overs_), handed_over_, path_->heard);
}

/// A leg's motion as that along the path.
Motion StopAndTurn::Whole(Motion of_leg) const {
  of_leg.path_id = path_->id;
  for (std::size_t n = 0; n < legs_.size(); ++n) {
    if (n < leg_) of_leg.distance_done += legs_[n].length;
    if (n > leg_) of_leg.distance_left += legs_[n].length;
  }
  if (legs_.empty() && of_leg.reason == StopReason::kEmptyPath && !path_->T_WBs.empty()) {
    // The empty path is ours, not the explorer's.
    of_leg.distance_left = path_->length;
    const bool brakes = !follower_.standing();
    of_leg.state = brakes ? MotionState::kFollowing : MotionState::kStopped;
    of_leg.reason = brakes ? StopReason::kNone : StopReason::kOffPath;
  }
  return of_leg;
}

}  // namespace thalweg::controller
