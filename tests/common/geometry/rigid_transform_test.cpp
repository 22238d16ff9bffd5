#include "common/geometry/rigid_transform.h"

#include <gtest/gtest.h>

#include <numbers>

#include "common/base/angles.h"
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

TEST(RigidTransform, TurnsOnTheSpotByNoMoreThanItMay) {
  const RigidTransform a = MakeTransform(RotationFromYawPitch(0.9 * kPi, 0.0), {1.0, 2.0, 3.0});
  const RigidTransform b = MakeTransform(RotationFromYawPitch(-0.9 * kPi, 0.0), {3.0, 2.0, -1.0});
  const RigidTransform part = TurnedTowards(a, b, 0.15 * kPi);
  EXPECT_EQ(part.translation(), a.translation());
  EXPECT_NEAR(AngleBetween(a, part), 0.15 * kPi, 1e-12);
  EXPECT_NEAR(AngleBetween(part, b), 0.05 * kPi, 1e-12);
  EXPECT_TRUE(TurnedTowards(a, b, 1.0).linear().isApprox(b.linear(), 1e-12));
  EXPECT_TRUE(TurnedTowards(a, a, 1.0).matrix() == a.matrix());
}

TEST(RigidTransform, ALongChainOfInterpolationsStaysARotation) {
  RigidTransform T = MakeTransform(RotationFromYawPitch(0.1, 0.2), {0.0, 0.0, 0.0});
  for (int n = 0; n < 2000; ++n) {
    T = Interpolate(T, MakeTransform(RotationFromYawPitch(0.3 * n, 0.1 * (n % 7)), {1.0, 0.0, 0.0}), 0.3);
  }
  EXPECT_NEAR(T.linear().determinant(), 1.0, 1e-12);
  EXPECT_TRUE((T.linear() * T.linear().transpose()).isIdentity(1e-12));
}

TEST(RigidTransform, InAPlaneOnlyPlaceAndHeadingAreLeft) {
  const Eigen::Matrix3d rolled =
      RotationFromYawPitch(2.5, 0.6) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_NEAR(YawOf(rolled), 2.5, 1e-12);
  const RigidTransform T = InPlane(MakeTransform(rolled, {1.0, -2.0, 3.0}), 0.35);
  EXPECT_TRUE(T.isApprox(MakeTransform(RotationFromYawPitch(2.5, 0.0), {1.0, -2.0, 0.35}), 1e-12));
  EXPECT_TRUE(InPlane(T, 0.35).isApprox(T, 1e-15));
}

TEST(RobotModel, OneThatDrivesExploresTheLayerThatItsBodySweepsWithinTheBounds) {
  const Eigen::AlignedBox3d bounds(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(6, 8, 2));
  RobotModel robot{.height = 0.4};
  EXPECT_TRUE(ExploredBounds(robot, {1, 1, 0.35}, bounds).isApprox(bounds)) << "it flies";
  robot.drives = true;
  const Eigen::AlignedBox3d layer(Eigen::Vector3d(0, 0, 0.15), Eigen::Vector3d(6, 8, 0.55));
  EXPECT_TRUE(ExploredBounds(robot, {1, 1, 0.35}, bounds).isApprox(layer));
  EXPECT_EQ(ExploredBounds(robot, {1, 1, 0.1}, bounds).min().z(), 0.0);
  EXPECT_EQ(ExploredBounds(robot, {1, 1, 1.9}, bounds).max().z(), 2.0);
  EXPECT_TRUE(ExploredBounds(robot, {1, 1, 2.5}, bounds).isEmpty());
}

TEST(RobotModel, DefaultDepthSensorHasTheThesisFieldOfView) {
  const PinholeCamera camera = DepthSensorModel{}.camera;
  EXPECT_NEAR(2.0 * std::atan(0.5 * camera.width_px / camera.fx), 75.0 * kDegree, 1e-12);
}

TEST(YawOf, IsTheHeadingEvenStraightUpAndDown) {
  for (const double yaw : {-3.0, -1.0, 0.2, 2.5}) {
    for (const double pitch : {-0.5 * std::numbers::pi, -1.5, 0.0, 1.3, 0.5 * std::numbers::pi})
      EXPECT_NEAR(YawOf(RotationFromYawPitch(yaw, pitch)), yaw, 1e-9) << pitch;
  }
}

}  // namespace
}  // namespace thalweg
