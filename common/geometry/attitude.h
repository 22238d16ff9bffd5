#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/rigid_transform.h"
#include "common/geometry/robot_model.h"

namespace thalweg {

/// [rad] Heading and elevation of a body without roll; the heading is that of its y axis, less a right angle,
/// so that it is one even where the x axis is vertical.
struct YawPitch {
  double yaw = 0.0;
  double pitch = 0.0;
};
inline YawPitch YawPitchOf(const Eigen::Matrix3d& R_WB) {
  return {std::atan2(-R_WB(0, 1), R_WB(1, 1)), std::atan2(R_WB(2, 0), std::hypot(R_WB(0, 0), R_WB(1, 0)))};
}

/// [rad] The difference of two headings or of two angles alike, -pi to pi.
inline double WrappedAngle(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

/// The pose with the orientation that a robot can have: for one that cannot turn freely without roll, and
/// with a pitch within its limits.
inline RigidTransform Held(const RobotModel& robot, const RigidTransform& T_WB) {
  if (robot.turns_freely()) return T_WB;
  if (robot.level()) return Leveled(T_WB);
  // The optical axis stays where it is, as far as it can.
  return MakeTransform(
      RotationFromYawPitch(YawOf(T_WB.linear()), robot.PitchWithin(YawPitchOf(T_WB.linear()).pitch)),
      T_WB.translation());
}

/// Turns a robot in place toward b's orientation as far as it comes in a time [s]: along the shortest arc, or
/// if it has a gimbal by heading and pitch, each at its own rate. @param a, b  Held.
inline RigidTransform TurnedFor(const RobotModel& robot, const RigidTransform& a, const RigidTransform& b,
                                double time) {
  if (!robot.gimballed()) return TurnedTowards(a, b, robot.max_turn_rate * time);
  const YawPitch from = YawPitchOf(a.linear());
  const YawPitch to = YawPitchOf(b.linear());
  const double yaw = WrappedAngle(to.yaw - from.yaw);
  const double pitch = to.pitch - from.pitch;
  const double most_yaw = robot.max_turn_rate * time;
  const double most_pitch = robot.max_gimbal_rate * time;
  if (std::abs(yaw) <= most_yaw && std::abs(pitch) <= most_pitch)
    return MakeTransform(b.linear(), a.translation());
  return MakeTransform(RotationFromYawPitch(from.yaw + std::clamp(yaw, -most_yaw, most_yaw),
                                            from.pitch + std::clamp(pitch, -most_pitch, most_pitch)),
                       a.translation());
}

}  // namespace thalweg
