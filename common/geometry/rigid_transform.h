#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace thalweg {

/// A pose or change of frame. `T_WC` is the pose of C in W and maps points from C to W.
///
/// Frames (docs in README): W world (x forward at start, y left, z up), B body (x forward, y left, z up),
/// C camera (x right, y down, z forward along the optical axis).
using RigidTransform = Eigen::Isometry3d;

/// The camera that looks along B's x axis: R_BC for a camera mounted without tilt.
inline Eigen::Matrix3d BodyFromOptical() {
  Eigen::Matrix3d R_BC;
  R_BC << 0, 0, 1,  //
      -1, 0, 0,     //
      0, -1, 0;
  return R_BC;
}

/// R_WB for a heading and an elevation without roll.
/// @param yaw    [rad] counter-clockwise about z from W's x axis.
/// @param pitch  [rad] upwards positive: the body's x axis points above the horizon.
inline Eigen::Matrix3d RotationFromYawPitch(double yaw, double pitch) {
  return (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(-pitch, Eigen::Vector3d::UnitY()))
      .toRotationMatrix();
}

/// [rad] The heading of a body: that of its x axis, seen from above; any when that is vertical.
inline double YawOf(const Eigen::Matrix3d& R_WB) {
  return std::atan2(R_WB(1, 0), R_WB(0, 0));
}

inline RigidTransform MakeTransform(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  RigidTransform T = RigidTransform::Identity();
  T.linear() = rotation;
  T.translation() = translation;
  return T;
}

/// The same place and heading in a level plane, the body level, too. @param z  [m] Of the plane.
inline RigidTransform InPlane(const RigidTransform& T_WB, double z) {
  return MakeTransform(RotationFromYawPitch(YawOf(T_WB.linear()), 0.0),
                       {T_WB.translation().x(), T_WB.translation().y(), z});
}

/// Straight line for the position, shortest arc for the rotation. @param share 0 gives a, 1 gives b.
inline RigidTransform Interpolate(const RigidTransform& a, const RigidTransform& b, double share) {
  // Normalised, since errors of rounding would grow with each step of a chain of interpolations.
  const Eigen::Quaterniond q_a = Eigen::Quaterniond(a.linear()).normalized();
  const Eigen::Quaterniond q_b = Eigen::Quaterniond(b.linear()).normalized();
  return MakeTransform(q_a.slerp(share, q_b).normalized().toRotationMatrix(),
                       a.translation() + share * (b.translation() - a.translation()));
}

/// Angle of the rotation between the two, [rad], 0 to pi.
inline double AngleBetween(const RigidTransform& a, const RigidTransform& b) {
  return Eigen::Quaterniond(a.linear()).angularDistance(Eigen::Quaterniond(b.linear()));
}

/// At a's place, turned from there towards b's orientation by the shortest arc. @param most  [rad] No
/// further.
inline RigidTransform TurnedTowards(const RigidTransform& a, const RigidTransform& b, double most) {
  const RigidTransform there = MakeTransform(b.linear(), a.translation());
  const double angle = AngleBetween(a, there);
  return angle > 0.0 ? Interpolate(a, there, std::min(1.0, most / angle)) : a;
}

}  // namespace thalweg
