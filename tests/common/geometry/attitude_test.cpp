#include "common/geometry/attitude.h"

#include <gtest/gtest.h>

#include "common/base/angles.h"

namespace thalweg {
namespace {

const RobotModel kGimballed{.attitude = Attitude::kGimbal};

RigidTransform Looking(double yaw, double pitch) {
  return MakeTransform(RotationFromYawPitch(yaw, pitch), {1.0, 2.0, 3.0});
}

TEST(YawPitchOf, IsTheInverseOfTheRotationEvenStraightDown) {
  for (const double yaw : {-3.0, -0.4, 0.0, 1.0, 3.1}) {
    for (const double pitch : {-0.5 * std::numbers::pi, -1.0, 0.0, 0.7, 0.5 * std::numbers::pi}) {
      const YawPitch of = YawPitchOf(RotationFromYawPitch(yaw, pitch));
      EXPECT_NEAR(of.yaw, yaw, 1e-9);
      EXPECT_NEAR(of.pitch, pitch, 1e-7);
    }
  }
}

TEST(Held, IsThePoseThatTheRobotCanHave) {
  const RigidTransform tilted = MakeTransform(
      RotationFromYawPitch(0.4, 1.2) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()), {1, 2, 3});
  EXPECT_TRUE(Held({}, tilted).isApprox(tilted, 1e-15));
  EXPECT_TRUE(Held({.attitude = Attitude::kLevel}, Looking(0.4, 1.2)).isApprox(Looking(0.4, 0.0), 1e-12));
  EXPECT_TRUE(Held({.attitude = Attitude::kGimbal, .drives = true}, Looking(0.4, 1.2))
                  .isApprox(Looking(0.4, 0.0), 1e-12))
      << "one that drives is level whatever its attitude says";
  EXPECT_TRUE(Held(kGimballed, Looking(0.4, 1.2)).isApprox(Looking(0.4, kGimballed.gimbal_highest), 1e-12));
  EXPECT_TRUE(Held(kGimballed, Looking(0.4, -1.2)).isApprox(Looking(0.4, -1.2), 1e-12));
  EXPECT_NEAR(Held(kGimballed, tilted).linear()(2, 1), 0.0, 1e-12) << "no roll";
}

TEST(TurnedFor, TurnsHeadingAndPitchOfAGimbalEachAtItsRate) {
  const double second = 0.5;
  const RigidTransform from = Looking(3.0, 0.2);
  const RigidTransform turned = TurnedFor(kGimballed, from, Looking(-2.0, -1.4), second);
  const YawPitch now = YawPitchOf(turned.linear());
  EXPECT_NEAR(WrappedAngle(now.yaw - 3.0), kGimballed.max_turn_rate * second, 1e-9) << "the shorter way";
  EXPECT_NEAR(now.pitch, 0.2 - kGimballed.max_gimbal_rate * second, 1e-9);
  EXPECT_TRUE(turned.translation().isApprox(from.translation()));
  EXPECT_EQ(TurnedFor(kGimballed, from, Looking(-2.0, -1.4), 60.0).linear(), Looking(-2.0, -1.4).linear());
}

TEST(TurnedFor, TurnsOthersAlongTheShortestArc) {
  const RobotModel robot;
  const RigidTransform from = Looking(0.0, 0.0);
  const RigidTransform to = Looking(1.0, 0.9);
  EXPECT_TRUE(TurnedFor(robot, from, to, 0.1).isApprox(TurnedTowards(from, to, 0.1 * robot.max_turn_rate)));
}

}  // namespace
}  // namespace thalweg
