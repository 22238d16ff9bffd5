#include "common/geometry/rigid_transform.h"

#include <gtest/gtest.h>

#include <numbers>

#include "common/geometry/robot_model.h"

namespace thalweg {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(RigidTransform, CameraLooksAlongTheBodysXAxisWithItsXToTheRight) {
  const Eigen::Matrix3d R_BC = BodyFromOptical();
  EXPECT_TRUE((R_BC * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitX()));
  EXPECT_TRUE((R_BC * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitY()));
  EXPECT_TRUE((R_BC * Eigen::Vector3d::UnitY()).isApprox(-Eigen::Vector3d::UnitZ()));
  EXPECT_NEAR(R_BC.determinant(), 1.0, 1e-15);
}

TEST(RigidTransform, YawTurnsLeftAndPitchLooksUp) {
  EXPECT_TRUE(
      (RotationFromYawPitch(kPi / 2, 0.0) * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
  const Eigen::Vector3d up = RotationFromYawPitch(0.3, kPi / 6) * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(up.z(), 0.5, 1e-12);
  EXPECT_NEAR(std::atan2(up.y(), up.x()), 0.3, 1e-12);
}

TEST(RigidTransform, InterpolatesTheStraightLineAndTheShortestArc) {
  const RigidTransform a = MakeTransform(RotationFromYawPitch(0.9 * kPi, 0.0), {1.0, 2.0, 3.0});
  const RigidTransform b = MakeTransform(RotationFromYawPitch(-0.9 * kPi, 0.0), {3.0, 2.0, -1.0});
  const RigidTransform middle = Interpolate(a, b, 0.5);
  EXPECT_TRUE(middle.translation().isApprox(Eigen::Vector3d(2.0, 2.0, 1.0)));
  EXPECT_TRUE(middle.linear().isApprox(RotationFromYawPitch(kPi, 0.0), 1e-12));
  EXPECT_NEAR(AngleBetween(a, b), 0.2 * kPi, 1e-12);
  EXPECT_NEAR(AngleBetween(a, Interpolate(a, b, 0.25)), 0.05 * kPi, 1e-12);
}

TEST(RigidTransform, ALongChainOfInterpolationsStaysARotation) {
  RigidTransform T = MakeTransform(RotationFromYawPitch(0.1, 0.2), {0.0, 0.0, 0.0});
  for (int n = 0; n < 2000; ++n) {
    T = Interpolate(T, MakeTransform(RotationFromYawPitch(0.3 * n, 0.1 * (n % 7)), {1.0, 0.0, 0.0}), 0.3);
  }
  EXPECT_NEAR(T.linear().determinant(), 1.0, 1e-12);
  EXPECT_TRUE((T.linear() * T.linear().transpose()).isIdentity(1e-12));
}

TEST(RobotModel, DefaultDepthSensorHasTheThesisFieldOfView) {
  const PinholeCamera camera = DepthSensorModel{}.camera;
  EXPECT_NEAR(2.0 * std::atan(0.5 * camera.width_px / camera.fx), 75.0 * kPi / 180.0, 1e-12);
}

}  // namespace
}  // namespace thalweg
