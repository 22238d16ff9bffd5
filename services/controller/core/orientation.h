#pragma once

#include <Eigen/Geometry>

#include "common/geometry/attitude.h"
#include "common/geometry/robot_model.h"

namespace thalweg::controller {

/// An orientation that is commanded, and how it turns: along the shortest arc, or for a robot with a gimbal
/// by heading and pitch, each for itself. Rates rise and fall at the greatest acceleration and end at rest.
/// Threading: one thread.
class Orientation {
 public:
  struct Limits {
    double rate = RobotModel{}.max_turn_rate;                  ///< [rad/s]
    double acceleration = RobotModel{}.max_turn_acceleration;  ///< [rad/s^2] About each axis.
    double gimbal_rate = 0.0;  ///< [rad/s] The pitch's; 0 = there is no gimbal.
  };
  explicit Orientation(const Limits& limits) : limits_(limits) {}

  /// Stands there.
  void Place(const Eigen::Quaterniond& q_WB);
  /// Turns on for `dt` [s] > 0. @param most  [rad/s] Not faster than this, if that is possible.
  void TurnTo(const Eigen::Quaterniond& wanted, double most, double dt);
  /// Turns to `wanted` within `dt` [s] > 0, at whatever rate that takes.
  void TurnWith(const Eigen::Quaterniond& wanted, double dt);
  /// Turns on while braking. @param harder  Factor of the acceleration.
  void Brake(double harder, double dt);
  void Stop() { rate_B_.setZero(), rates_.setZero(); }

  const Eigen::Quaterniond& q_WB() const { return q_WB_; }
  const Eigen::Vector3d& rate_B() const { return rate_B_; }  ///< [rad/s]

 private:
  bool has_gimbal() const { return limits_.gimbal_rate > 0.0; }
  double RateFor(double angle, double greatest, double dt) const;
  void Turn(const Eigen::Vector3d& rate_B, double dt);
  void TurnGimbal(const Eigen::Vector2d& rates, double dt);

  Limits limits_;
  Eigen::Quaterniond q_WB_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d rate_B_ = Eigen::Vector3d::Zero();
  YawPitch at_;                                      ///< The same as q_WB_, with a gimbal.
  Eigen::Vector2d rates_ = Eigen::Vector2d::Zero();  ///< [rad/s] Heading and pitch, with a gimbal.
};

}  // namespace thalweg::controller
