#include "services/evaluator/core/motion_meter.h"

#include <algorithm>
#include <cmath>

namespace thalweg::evaluator {
namespace {

// Slower than this is rounding.
constexpr double kStands = 1e-6;  // [m/s, rad/s]

}  // namespace

void MotionMeter::Move(const RigidTransform& T_WB, double dt) {
  const RigidTransform before = T_WB_;
  T_WB_ = T_WB;
  time_ += dt;
  const Eigen::Vector3d v_W = (T_WB.translation() - before.translation()) / dt;
  const Eigen::AngleAxisd turn(before.linear().transpose() * T_WB.linear());
  // An angle of rotation matrices is only good to the root of the rounding error.
  constexpr double kRounding = 1e-7;  // [rad]
  const double angle = turn.angle() > kRounding ? turn.angle() : 0.0;
  const Eigen::Vector3d w_W = before.linear() * (angle * turn.axis()) / dt;
  const bool moves = v_W.norm() > kStands;
  figures_.moving += moves ? dt : 0.0;
  figures_.turning += !moves && w_W.norm() > kStands ? dt : 0.0;
  figures_.standing += !moves && w_W.norm() <= kStands ? dt : 0.0;
  figures_.stops += moved_ && !moves ? 1 : 0;
  moved_ = moves;

  recent_.push_back({time_, v_W, w_W});
  const Rates& then = recent_.front();
  figures_.most_speed = std::max(figures_.most_speed, v_W.norm());
  figures_.most_sideways_speed =
      std::max(figures_.most_sideways_speed, std::abs(v_W.dot(before.linear().col(1))));
  if (moves) figures_.sharpest_curve = std::max(figures_.sharpest_curve, w_W.norm() / v_W.norm());
  figures_.most_turn_rate = std::max(figures_.most_turn_rate, w_W.norm());
  if (time_ - then.time < kWindow - 1e-9) return;
  const double span = time_ - then.time;
  const Eigen::Vector3d a_W = (v_W - then.v_W) / span;
  figures_.most_acceleration = std::max(figures_.most_acceleration, a_W.norm());
  figures_.most_turn_acceleration = std::max(figures_.most_turn_acceleration, (w_W - then.w_W).norm() / span);
  recent_.pop_front();
  recent_accelerations_.push_back({time_, a_W});
  const Acceleration& former = recent_accelerations_.front();
  if (time_ - former.time < kWindow - 1e-9) return;
  figures_.most_jerk = std::max(figures_.most_jerk, (a_W - former.a_W).norm() / (time_ - former.time));
  recent_accelerations_.pop_front();
}

}  // namespace thalweg::evaluator
