#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/camera/stereo_bias.h"
#include "common/geometry/rigid_transform.h"
#include "common/geometry/stereo_geometry.h"

namespace thalweg::visual_odometry {

/// A point in a camera frame as q = (x/z, y/z, 1/z). Stereo measurements are linear in q, so that its errors
/// stay Gaussian at any distance [Civera et al., Inverse Depth Parametrization for Monocular SLAM, T-RO
/// 24(5), 2008]; 1/z = 0 is a point at infinity and needs no special treatment.
using InverseDepthPoint = Eigen::Vector3d;

/// Smallest useful ScaledTransform().z(): a point closer to the camera's own plane lies beside the camera.
inline constexpr double kLeastForward = 0.05;

/// Image coordinates of a point in both images: (u_left, v, u_right) [px].
using StereoPixel = Eigen::Vector3d;

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix62d = Eigen::Matrix<double, 6, 2>;

/// Triangulates the point seen at these pixels.
inline InverseDepthPoint Triangulate(const StereoGeometry& rig, const StereoPixel& pixel) {
  const PinholeCamera& c = rig.camera;
  return {(pixel[0] - c.cx) / c.fx, (pixel[1] - c.cy) / c.fy, (pixel[0] - pixel[2]) / (c.fx * rig.baseline)};
}

/// Frees the right pixel of the camera's systematic error.
inline StereoPixel Unbiased(const StereoGeometry& rig, const StereoPixel& pixel, const DisparityBias& bias) {
  return {pixel[0], pixel[1], pixel[2] - bias.dot(BiasBasis(rig.camera, pixel[2]))};
}

/// By how much the inverse depth of a triangulated point grows with the bias that is assumed: d q[2] / d c.
inline Eigen::RowVector2d InverseDepthByBias(const StereoGeometry& rig, double u_right) {
  return BiasBasis(rig.camera, u_right).transpose() / (rig.camera.fx * rig.baseline);
}

/// d q / d (u_left, v, u_right), which is constant.
inline Eigen::Matrix3d TriangulationJacobian(const StereoGeometry& rig) {
  const double per_disparity = 1.0 / (rig.camera.fx * rig.baseline);
  Eigen::Matrix3d jacobian;
  jacobian << 1.0 / rig.camera.fx, 0, 0,  //
      0, 1.0 / rig.camera.fy, 0,          //
      per_disparity, 0, -per_disparity;
  return jacobian;
}

/// m = R (a, b, 1) + rho t: the point in frame B, divided by its depth in A.
inline Eigen::Vector3d ScaledTransform(const RigidTransform& T_BA, const InverseDepthPoint& q_A) {
  return T_BA.linear() * Eigen::Vector3d(q_A[0], q_A[1], 1.0) + q_A[2] * T_BA.translation();
}

/// Transforms a point to another frame. Defined only where it lies in front of that camera
/// (ScaledTransform().z() > 0).
inline InverseDepthPoint TransformPoint(const RigidTransform& T_BA, const InverseDepthPoint& q_A) {
  const Eigen::Vector3d m = ScaledTransform(T_BA, q_A);
  return {m.x() / m.z(), m.y() / m.z(), q_A[2] / m.z()};
}

/// d TransformPoint / d q_A.
inline Eigen::Matrix3d TransformPointJacobian(const RigidTransform& T_BA, const InverseDepthPoint& q_A) {
  const Eigen::Vector3d m = ScaledTransform(T_BA, q_A);
  Eigen::Matrix3d dm;  // d m / d q
  dm << T_BA.linear().col(0), T_BA.linear().col(1), T_BA.translation();
  const double w = 1.0 / m.z();
  Eigen::Matrix3d jacobian;
  jacobian.row(0) = w * (dm.row(0) - m.x() * w * dm.row(2));
  jacobian.row(1) = w * (dm.row(1) - m.y() * w * dm.row(2));
  jacobian.row(2) = Eigen::RowVector3d(0, 0, w) - q_A[2] * w * w * dm.row(2);
  return jacobian;
}

/// Projects a scaled point m with inverse depth rho. Requires m.z() > 0.
inline StereoPixel ProjectScaled(const StereoGeometry& rig, const Eigen::Vector3d& m, double rho) {
  const PinholeCamera& c = rig.camera;
  const double w = 1.0 / m.z();
  const double u = c.fx * m.x() * w + c.cx;
  return {u, c.fy * m.y() * w + c.cy, u - c.fx * rig.baseline * rho * w};
}

inline StereoPixel Project(const StereoGeometry& rig, const RigidTransform& T_BA,
                           const InverseDepthPoint& q_A) {
  return ProjectScaled(rig, ScaledTransform(T_BA, q_A), q_A[2]);
}

/// d pixel / d m for constant rho.
inline Eigen::Matrix3d ProjectionJacobian(const StereoGeometry& rig, const Eigen::Vector3d& m, double rho) {
  const PinholeCamera& c = rig.camera;
  const double w = 1.0 / m.z();
  Eigen::Matrix3d jacobian;
  jacobian << c.fx * w, 0, -c.fx * m.x() * w * w,  //
      0, c.fy * w, -c.fy * m.y() * w * w,          //
      c.fx * w, 0, -c.fx * (m.x() - rig.baseline * rho) * w * w;
  return jacobian;
}

/// d pixel / d q_A of Project.
inline Eigen::Matrix3d PointJacobian(const StereoGeometry& rig, const RigidTransform& T_BA,
                                     const InverseDepthPoint& q_A) {
  const Eigen::Vector3d m = ScaledTransform(T_BA, q_A);
  Eigen::Matrix3d dm;
  dm << T_BA.linear().col(0), T_BA.linear().col(1), T_BA.translation();
  Eigen::Matrix3d jacobian = ProjectionJacobian(rig, m, q_A[2]) * dm;
  jacobian(2, 2) -= rig.camera.fx * rig.baseline / m.z();
  return jacobian;
}

inline Eigen::Matrix3d Cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

inline Eigen::Matrix3d RotationFromVector(const Eigen::Vector3d& angle) {
  const double length = angle.norm();
  if (length < 1e-12) return Eigen::Matrix3d::Identity() + Cross(angle);
  return Eigen::AngleAxisd(length, angle / length).toRotationMatrix();
}

/// The inverse of RotationFromVector.
inline Eigen::Vector3d VectorFromRotation(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

/// Applies a small motion (v, w) from the left: p' = exp(w) p + v. Tangent vectors of poses have this order.
inline RigidTransform Moved(const Vector6d& step, const RigidTransform& T) {
  const Eigen::Matrix3d R = RotationFromVector(step.tail<3>());
  return MakeTransform(R * T.linear(), R * T.translation() + step.head<3>());
}

/// d pixel / d (v, w) of Project(Moved((v, w), T_BA), q_A) at 0.
inline Eigen::Matrix<double, 3, 6> PoseJacobian(const StereoGeometry& rig, const RigidTransform& T_BA,
                                                const InverseDepthPoint& q_A) {
  const Eigen::Vector3d m = ScaledTransform(T_BA, q_A);
  Eigen::Matrix<double, 3, 6> dm;
  dm << q_A[2] * Eigen::Matrix3d::Identity(), -Cross(m);
  return ProjectionJacobian(rig, m, q_A[2]) * dm;
}

/// Maps x in T = exp(x) T_mean to that in A T A^-1 = exp(Adjoint(A) x) A T_mean A^-1.
inline Matrix6d Adjoint(const RigidTransform& A) {
  Matrix6d adjoint = Matrix6d::Zero();
  adjoint.topLeftCorner<3, 3>() = A.linear();
  adjoint.bottomRightCorner<3, 3>() = A.linear();
  adjoint.topRightCorner<3, 3>() = Cross(A.translation()) * A.linear();
  return adjoint;
}

/// [m], [rad] From a covariance of (v, w): square root of the sum of variances over the three axes.
inline double PositionSigma(const Matrix6d& covariance) {
  return std::sqrt(std::max(0.0, covariance.topLeftCorner<3, 3>().trace()));
}
inline double RotationSigma(const Matrix6d& covariance) {
  return std::sqrt(std::max(0.0, covariance.bottomRightCorner<3, 3>().trace()));
}

}  // namespace thalweg::visual_odometry
