#include "services/explorer/core/path/motion_times.h"

#include <gtest/gtest.h>

#include "common/base/angles.h"

namespace thalweg::explorer {
namespace {

RobotModel Robot() {
  RobotModel robot;
  robot.max_speed = 2.0;
  robot.max_acceleration = 4.0;
  robot.max_turn_rate = 90.0 * kDegree;
  robot.max_turn_acceleration = 180.0 * kDegree;
  return robot;
}

TEST(TravelTime, IsThatOfAWayFromRestToRest) {
  EXPECT_EQ(TravelTime(0.0, Robot()), 0.0);
  EXPECT_NEAR(TravelTime(0.25, Robot()), 0.5, 1e-12) << "half of it at 4 m/s^2 takes a quarter of a second";
  EXPECT_NEAR(TravelTime(1.0, Robot()), 1.0, 1e-12) << "the full speed is just reached";
  EXPECT_NEAR(TravelTime(3.0, Robot()), 2.0, 1e-12) << "2 m more at 2 m/s";
}

TEST(TurnTime, IsThatOfATurnFromRestToRest) {
  EXPECT_EQ(TurnTime(0.0, Robot()), 0.0);
  EXPECT_NEAR(TurnTime(45.0 * kDegree, Robot()), 1.0, 1e-12) << "the full rate is just reached";
  EXPECT_NEAR(TurnTime(180.0 * kDegree, Robot()), 2.5, 1e-12) << "135 degrees more at the full rate";
}

TEST(TurnTime, OfARobotThatTurnsOnlyInCurvesIsThatOfItsWay) {
  RobotModel robot = Robot();
  robot.drives = true;
  robot.drive = Drive::kAckermann;
  robot.min_turning_radius = 1.5;
  EXPECT_NEAR(TurnTime(2.0, robot), TravelTime(3.0, robot), 1e-12);
}

TEST(TurnTime, OfAGimbalIsThatOfTheSlowerAxis) {
  RobotModel robot = Robot();
  const Eigen::Matrix3d ahead = RotationFromYawPitch(0.0, 0.0);
  const Eigen::Matrix3d aside = RotationFromYawPitch(90.0 * kDegree, -45.0 * kDegree);
  EXPECT_NEAR(TurnTime(ahead, aside, robot), TurnTime(AngleBetween(ahead, aside), robot), 1e-12);
  robot.attitude = Attitude::kGimbal;
  robot.max_gimbal_rate = 180.0 * kDegree;
  EXPECT_NEAR(TurnTime(ahead, aside, robot), TurnTime(90.0 * kDegree, robot), 1e-9);
  robot.max_gimbal_rate = 15.0 * kDegree;
  EXPECT_NEAR(TurnTime(ahead, aside, robot), 45.0 / 15.0 + 15.0 / 180.0, 1e-9);
}

TEST(UsualPath, IsTraveledAtHalfOfTheGreatestSpeed) {
  EXPECT_NEAR(UsualPath(3.0, Robot()), 3.0, 1e-12);
}

}  // namespace
}  // namespace thalweg::explorer
