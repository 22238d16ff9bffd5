#include <algorithm>
#include <cmath>

#include "services/controller/core/braking_time.h"
#include "services/controller/core/path_follower.h"

namespace thalweg::controller {
namespace {

constexpr double kTick = 0.02;  // [s]

}  // namespace

/// As if all that is still valid were repeated.
void PathFollower::HearAgain(Time now) {
  if (!path_silent_) path_heard_ = now;
  if (lost_) lost_ = now;
  map_heard_ = now;
}

TrajectoryPoint PathFollower::Moment(double time) const {
  if (back_) {
    const Eigen::Matrix3d R_WB = back_->T_WB.linear();
    return {.time = time, .T_WB = back_->T_WB, .v_W = R_WB * back_->v_WB_B, .w_W = R_WB * back_->w_WB_B};
  }
  return {.time = time,
          .T_WB = MakeTransform(orientation_.q_WB().toRotationMatrix(), CommandedPosition()),
          .v_W = CommandedVelocity(),
          .w_W = orientation_.q_WB() * orientation_.rate_B()};
}

std::vector<TrajectoryPoint> PathFollower::Preview(double step, double horizon) const {
  if (!has_command_ || !path_ || !last_step_) return {};
  PathFollower ahead = *this;
  ahead.previews_ = true;
  if (!Lost(*last_step_)) ahead.lost_.reset();
  std::vector<TrajectoryPoint> moments{ahead.Moment(0.0)};
  const double longest_brake = BrakingTime(options_.robot) + options_.robot.smoothing();
  bool ends = false;
  bool stands = false;
  while (!stands && moments.back().time < horizon + longest_brake + 1.0) {
    const double time = kTick * static_cast<double>(moments.size());
    const Time now = *last_step_ + FromSeconds(time);
    ahead.HearAgain(now);
    if (!ends && time > horizon) {
      ends = true;
      ahead.options_.emergency_factor = 1.0;
      ahead.lost_.reset();
      ahead.SetPath(now, {}, now);
    }
    ahead.SetPose(moments.back().T_WB, now);
    ahead.pose_silent_ = pose_silent_;
    const Motion motion = ahead.Step(now);
    moments.push_back(ahead.Moment(time));
    stands = motion.state != MotionState::kFollowing && !ahead.back_ && ahead.standing();
  }
  for (std::size_t n = 0; n + 1 < moments.size(); ++n) {
    moments[n].a_W = (moments[n + 1].v_W - moments[n].v_W) / kTick;
  }
  const auto every = static_cast<std::size_t>(std::max(1.0, std::round(step / kTick)));
  std::vector<TrajectoryPoint> points;
  for (std::size_t n = 0; n + 1 < moments.size(); n += every) points.push_back(moments[n]);
  const bool moved = moments.size() > 2 || !moments.front().T_WB.isApprox(moments.back().T_WB, 1e-12);
  if (moved) points.push_back(moments.back());
  return points;
}

}  // namespace thalweg::controller
