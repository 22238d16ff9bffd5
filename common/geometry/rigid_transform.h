#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace thalweg {

/// A pose or change of frame. `T_WC` is the pose of C in W and maps points from C to W.
///
/// Frames: W world (x forward at start, y left, z up), B body (x forward, y left, z up), C camera (x right, y
/// down, z forward along the optical axis).
using RigidTransform = Eigen::Isometry3d;

/// R_BC of a camera mounted without tilt, looking along B's x axis.
inline Eigen::Matrix3d BodyFromOptical() {
  Eigen::Matrix3d R_BC;
  R_BC << 0, 0, 1,  //
      -1, 0, 0,     //
      0, -1, 0;
  return R_BC;
}

/// R_WB for a given heading and elevation, without roll.
/// @param yaw    [rad] Counterclockwise about z, from W's x axis.
/// @param pitch  [rad] Positive when the body's x axis points above the horizon.
inline Eigen::Matrix3d RotationFromYawPitch(double yaw, double pitch) {
  return (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(-pitch, Eigen::Vector3d::UnitY()))
      .toRotationMatrix();
}

/// [rad] Heading of a body: the direction of its x axis, projected to the horizontal plane; within 8 deg of
/// the vertical that of its y axis, less a right angle.
inline double YawOf(const Eigen::Matrix3d& R_WB) {
  constexpr double kSteep = 0.99;
  if (std::abs(R_WB(2, 0)) > kSteep) return std::atan2(-R_WB(0, 1), R_WB(1, 1));
  return std::atan2(R_WB(1, 0), R_WB(0, 0));
}

inline RigidTransform MakeTransform(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  RigidTransform T = RigidTransform::Identity();
  T.linear() = rotation;
  T.translation() = translation;
  return T;
}

/// The same position and heading moved to a horizontal plane, with the body leveled.
/// @param z  [m] Height of the plane.
inline RigidTransform InPlane(const RigidTransform& T_WB, double z) {
  return MakeTransform(RotationFromYawPitch(YawOf(T_WB.linear()), 0.0),
                       {T_WB.translation().x(), T_WB.translation().y(), z});
}

/// The same position and heading, with the body leveled.
inline RigidTransform Leveled(const RigidTransform& T_WB) {
  return InPlane(T_WB, T_WB.translation().z());
}

/// Interpolates along a straight line in position and the shortest arc in rotation.
/// @param share  0 gives a, 1 gives b.
inline RigidTransform Interpolate(const RigidTransform& a, const RigidTransform& b, double share) {
  // Normalized, since rounding errors would otherwise grow along a chain of interpolations.
  const Eigen::Quaterniond q_a = Eigen::Quaterniond(a.linear()).normalized();
  const Eigen::Quaterniond q_b = Eigen::Quaterniond(b.linear()).normalized();
  return MakeTransform(q_a.slerp(share, q_b).normalized().toRotationMatrix(),
                       a.translation() + share * (b.translation() - a.translation()));
}

/// [rad] Angle of the rotation between two orientations, 0 to pi.
inline double AngleBetween(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle();
}
/// [rad] Angle of the rotation between the two, 0 to pi.
inline double AngleBetween(const RigidTransform& a, const RigidTransform& b) {
  return Eigen::Quaterniond(a.linear()).angularDistance(Eigen::Quaterniond(b.linear()));
}

/// Rotates a in place toward b's orientation, along the shortest arc.
/// @param most  [rad] Largest angle of the rotation.
inline RigidTransform TurnedTowards(const RigidTransform& a, const RigidTransform& b, double most) {
  const RigidTransform there = MakeTransform(b.linear(), a.translation());
  const double angle = AngleBetween(a, there);
  return angle > 0.0 ? Interpolate(a, there, std::min(1.0, most / angle)) : a;
}

}  // namespace thalweg
