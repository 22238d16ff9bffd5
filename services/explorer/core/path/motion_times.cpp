#include "services/explorer/core/path/motion_times.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/attitude.h"

namespace thalweg::explorer {
namespace {

constexpr double kUsualSpeed = 0.5;  // of the greatest

/// [s] For a way from rest to rest, by the greatest rate and its greatest change.
double Trapezoid(double way, double rate, double acceleration) {
  return way * acceleration < rate * rate ? 2.0 * std::sqrt(way / acceleration)
                                          : way / rate + rate / acceleration;
}

}  // namespace

double TravelTime(double length, const RobotModel& robot) {
  return Trapezoid(length, robot.max_speed, robot.max_acceleration);
}

double TurnTime(double angle, const RobotModel& robot) {
  if (!robot.turns_on_the_spot()) return TravelTime(angle * robot.min_turning_radius, robot);
  return Trapezoid(angle, robot.max_turn_rate, robot.max_turn_acceleration);
}

double TurnTime(const Eigen::Matrix3d& R_WB_from, const Eigen::Matrix3d& R_WB_to, const RobotModel& robot) {
  if (!robot.gimballed()) return TurnTime(AngleBetween(R_WB_from, R_WB_to), robot);
  const YawPitch from = YawPitchOf(R_WB_from);
  const YawPitch to = YawPitchOf(R_WB_to);
  return std::max(
      TurnTime(std::abs(WrappedAngle(to.yaw - from.yaw)), robot),
      Trapezoid(std::abs(to.pitch - from.pitch), robot.max_gimbal_rate, robot.max_turn_acceleration));
}

double UsualPath(double time, const RobotModel& robot) {
  return time * kUsualSpeed * robot.max_speed;
}

}  // namespace thalweg::explorer
