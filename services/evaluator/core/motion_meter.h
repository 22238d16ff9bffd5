#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <deque>

#include "common/geometry/rigid_transform.h"

namespace thalweg::evaluator {

/// Where the time of a run goes, and how fast the body was moved.
struct MotionFigures {
  double moving = 0.0;    ///< [s]
  double turning = 0.0;   ///< [s] While it stood.
  double standing = 0.0;  ///< [s] While it did not turn either.
  std::size_t stops = 0;  ///< Times that a moving body came to stand.
  // The greatest values, found by differentiating the poses.
  double most_speed = 0.0;              ///< [m/s]
  double most_acceleration = 0.0;       ///< [m/s^2] Over MotionMeter::kWindow, in any direction.
  double most_jerk = 0.0;               ///< [m/s^3] The change of that acceleration, over kWindow again.
  double most_sideways_speed = 0.0;     ///< [m/s] Across the direction that the body faces, horizontally.
  double sharpest_curve = 0.0;          ///< [1/m] Turn per way of a body that moves; one may turn freely.
  double most_turn_rate = 0.0;          ///< [rad/s]
  double most_turn_acceleration = 0.0;  ///< [rad/s^2] Likewise.
};

/// Takes a body's poses one after another and adds up what it did.
class MotionMeter {
 public:
  /// [s] Between the two velocities whose difference is an acceleration. Shorter than any maneuver, and
  /// longer than the steps in which a body goes around a corner that a polyline has and its path does not.
  static constexpr double kWindow = 0.1;

  explicit MotionMeter(const RigidTransform& T_WB_start) : T_WB_(T_WB_start) {}

  /// @param T_WB  The pose after the step. @param dt  [s] > 0, since the pose before.
  void Move(const RigidTransform& T_WB, double dt);
  const MotionFigures& figures() const { return figures_; }

 private:
  struct Rates {
    double time;  ///< [s]
    Eigen::Vector3d v_W;
    Eigen::Vector3d w_W;
  };
  MotionFigures figures_;
  RigidTransform T_WB_;
  double time_ = 0.0;  ///< [s]
  bool moved_ = false;
  struct Acceleration {
    double time;  ///< [s]
    Eigen::Vector3d a_W;
  };
  std::deque<Rates> recent_;  ///< The last window's, oldest first.
  std::deque<Acceleration> recent_accelerations_;
};

}  // namespace thalweg::evaluator
