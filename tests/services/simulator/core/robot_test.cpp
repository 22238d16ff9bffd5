#include "services/simulator/core/robot.h"

#include <gtest/gtest.h>

#include <numbers>

#include "common/geometry/attitude.h"
#include "tests/support/meshes.h"

namespace thalweg::simulator {
namespace {

const Eigen::AlignedBox3d kFlightBounds(Eigen::Vector3d(-50, -50, -50), Eigen::Vector3d(50, 50, 50));
constexpr double kTick = 0.02;

RigidTransform At(double x, double y = 0.0, double z = 0.0) {
  return MakeTransform(Eigen::Matrix3d::Identity(), {x, y, z});
}

/// A single sheet without thickness at x = 1.
World Sheet() {
  Mesh mesh;
  test::AddQuad(mesh, {1, -40, -40}, {0, 80, 0}, {0, 0, 80});
  return {mesh, kFlightBounds};
}

/// Renews the command each tick, as a controller does.
void Drive(SimulatedRobot& robot, const RigidTransform& target, double seconds) {
  for (int i = 0; i < static_cast<int>(seconds / kTick + 0.5); ++i) {
    robot.Command(target);
    robot.Step(kTick);
  }
}

TEST(SimulatedRobot, NeverPassesASheetAtAnySpeedAndStep) {
  const World world = Sheet();
  for (const double speed : {0.1, 0.5, 3.0, 100.0, 1e4}) {
    for (const double dt : {1e-3, 0.02, 0.3, 2.0}) {
      RobotModel model;
      model.max_speed = speed;
      SimulatedRobot robot(world, model, At(0.5));
      for (int i = 0; i < 2000 && robot.collisions() == 0; ++i) {
        robot.Command(At(30.0, 0.1 * (i % 7)));
        robot.Step(dt);
        ASSERT_GE(robot.clearance(), 0.0) << speed << ' ' << dt;
      }
      ASSERT_LE(robot.T_WB().translation().x(), 1.0 - model.radius + 1e-6);
      const bool arrives = speed * dt * 2000 > 1.0;
      if (arrives) {
        EXPECT_EQ(robot.collisions(), 1U) << speed << ' ' << dt;
      }
    }
  }
}

TEST(SimulatedRobot, NeverEntersAnySurfaceOnARandomPath) {
  const auto room = test::AnalyticRoom::Furnished();
  const World world(test::MeshOf(room), kFlightBounds);
  for (const double height : {0.0, 0.1, 0.5}) {
    for (const bool drives : {false, true}) {
      std::mt19937 random(8);
      const RobotModel model{.height = height, .drives = drives && height > 0.0, .max_speed = 4.0};
      SimulatedRobot robot(world, model, At(-0.5, 0.0, 0.0));
      for (int leg = 0; leg < 60; ++leg) {
        const RigidTransform target = room.RandomPose(random);
        for (int i = 0; i < 60; ++i) {
          robot.Command(target);
          robot.Step(kTick);
          ASSERT_GE(robot.clearance(), -1e-6);
        }
      }
      EXPECT_GT(robot.collisions(), 0U);
      EXPECT_GE(robot.least_clearance(), -1e-6);
    }
  }
}

TEST(SimulatedRobot, OneThatDrivesStaysLevelInItsPlaneAndTurnsToTheHeadingOfTheCommand) {
  const World world = Sheet();
  const RobotModel model{.height = 0.4, .drives = true};
  const Eigen::Matrix3d tilted =
      RotationFromYawPitch(2.0, 0.4) * Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()).toRotationMatrix();
  SimulatedRobot robot(world, model, MakeTransform(RotationFromYawPitch(0.3, 0.2), {-5.0, 0.0, 0.35}));
  EXPECT_TRUE(robot.T_WB().linear().isApprox(RotationFromYawPitch(0.3, 0.0), 1e-12)) << "from the start";
  for (int i = 0; i < 400; ++i) {
    robot.Command(MakeTransform(tilted, {-4.0, 1.0, 1.9}));
    robot.Step(kTick);
    ASSERT_EQ(robot.T_WB().translation().z(), 0.35);
    ASSERT_NEAR(robot.T_WB().linear()(2, 2), 1.0, 1e-12);
    ASSERT_NEAR(robot.v_WB_B().z(), 0.0, 1e-12);
    ASSERT_NEAR(robot.w_WB_B().head<2>().norm(), 0.0, 1e-9);
  }
  EXPECT_TRUE(robot.T_WB().translation().isApprox(Eigen::Vector3d(-4.0, 1.0, 0.35), 1e-9));
  EXPECT_TRUE(robot.T_WB().linear().isApprox(RotationFromYawPitch(2.0, 0.0), 1e-9));
  EXPECT_NEAR(robot.distance(), std::sqrt(2.0), 1e-6);
}

TEST(SimulatedRobot, OneWithADifferentialDriveDoesNotSlide) {
  const World world = Sheet();
  RobotModel model;
  model.drives = true;
  model.height = 0.2;
  model.drive = Drive::kDifferential;
  SimulatedRobot robot(world, model, At(0));
  Drive(robot, At(0, 1), 4.0);  // to its left
  EXPECT_EQ(robot.distance(), 0.0);
  const Eigen::Matrix3d left = RotationFromYawPitch(std::numbers::pi / 2.0, 0.0);
  Drive(robot, MakeTransform(left, {0, 0, 0}), 2.0);
  Drive(robot, MakeTransform(left, {0, 1, 0}), 4.0);
  EXPECT_TRUE(robot.T_WB().translation().isApprox(Eigen::Vector3d(0, 1, 0), 1e-6)) << "where it faces";
  Drive(robot, MakeTransform(left, {0, 0.5, 0}), 4.0);
  EXPECT_TRUE(robot.T_WB().translation().isApprox(Eigen::Vector3d(0, 0.5, 0), 1e-6)) << "and back";
}

TEST(SimulatedRobot, OneThatCannotTurnOnTheSpotFollowsAMovingCommandInCurves) {
  const World world = Sheet();
  RobotModel model;
  model.drives = true;
  model.height = 0.2;
  model.drive = Drive::kAckermann;
  model.min_turning_radius = 0.5;
  SimulatedRobot robot(world, model, At(0));
  Drive(robot, MakeTransform(RotationFromYawPitch(1.0, 0.0), {0, 0, 0}), 2.0);
  EXPECT_NEAR(AngleBetween(robot.T_WB(), At(0)), 0.0, 1e-12) << "it has no way to turn on";
  // An arc of 0.6 m to the left from 2 cm beside the robot, then back along the same.
  constexpr double kRadius = 0.6;
  const auto on_arc = [&](double angle) {
    return MakeTransform(RotationFromYawPitch(angle, 0.0),
                         {kRadius * std::sin(angle), 0.02 + kRadius * (1.0 - std::cos(angle)), 0.0});
  };
  const auto drive_on = [&](double from, double to) {
    const int ticks = static_cast<int>(std::abs(to - from) * kRadius / (0.3 * kTick));
    for (int n = 1; n <= ticks; ++n) {
      const RigidTransform before = robot.T_WB();
      robot.Command(on_arc(from + (to - from) * n / ticks));
      robot.Step(kTick);
      const Eigen::Vector3d step_B =
          before.linear().transpose() * (robot.T_WB().translation() - before.translation());
      ASSERT_NEAR(step_B.y(), 0.0, 1e-9) << "it does not slide";
      ASSERT_LE(AngleBetween(before, robot.T_WB()), step_B.norm() / model.min_turning_radius + 1e-9);
    }
  };
  drive_on(0.0, 2.0);
  EXPECT_LT((robot.T_WB().translation() - on_arc(2.0).translation()).norm(), 0.02);
  EXPECT_LT(AngleBetween(robot.T_WB(), on_arc(2.0)), 0.05);
  drive_on(2.0, 0.0);
  EXPECT_LT((robot.T_WB().translation() - on_arc(0.0).translation()).norm(), 0.02) << "and back";
}

TEST(SimulatedRobot, ALevelOneThatFliesRisesAndTurnsToTheHeadingOfTheCommand) {
  const World world = Sheet();
  const RobotModel model{.attitude = Attitude::kLevel};
  const Eigen::Matrix3d tilted =
      RotationFromYawPitch(2.0, 0.4) * Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()).toRotationMatrix();
  SimulatedRobot robot(world, model, MakeTransform(RotationFromYawPitch(0.3, 0.2), {-5.0, 0.0, 0.35}));
  EXPECT_TRUE(robot.T_WB().linear().isApprox(RotationFromYawPitch(0.3, 0.0), 1e-12)) << "from the start";
  for (int i = 0; i < 400; ++i) {
    robot.Command(MakeTransform(tilted, {-4.0, 1.0, 1.9}));
    robot.Step(kTick);
    ASSERT_NEAR(robot.T_WB().linear()(2, 2), 1.0, 1e-12);
    ASSERT_NEAR(robot.w_WB_B().head<2>().norm(), 0.0, 1e-9);
  }
  EXPECT_TRUE(robot.T_WB().translation().isApprox(Eigen::Vector3d(-4.0, 1.0, 1.9), 1e-9));
  EXPECT_TRUE(robot.T_WB().linear().isApprox(RotationFromYawPitch(2.0, 0.0), 1e-9));
}

TEST(SimulatedRobot, OneWithAGimbalTurnsByHeadingAndPitchAndStaysWithinItsLimits) {
  const World world = Sheet();
  const RobotModel model{.attitude = Attitude::kGimbal};
  SimulatedRobot robot(world, model, MakeTransform(RotationFromYawPitch(0.3, 0.8), {-5.0, 0.0, 0.35}));
  EXPECT_TRUE(robot.T_WB().linear().isApprox(RotationFromYawPitch(0.3, model.gimbal_highest), 1e-9));
  double yaw = 0.3;
  double pitch = model.gimbal_highest;
  for (int i = 0; i < 400; ++i) {
    robot.Command(MakeTransform(RotationFromYawPitch(2.9, -1.2), {-5.0, 0.0, 0.35}));
    robot.Step(kTick);
    const YawPitch now = YawPitchOf(robot.T_WB().linear());
    EXPECT_NEAR(robot.T_WB().linear()(2, 1), 0.0, 1e-9) << "no roll";
    EXPECT_LE(std::abs(now.yaw - yaw), model.max_turn_rate * kTick + 1e-9);
    EXPECT_LE(std::abs(now.pitch - pitch), model.max_gimbal_rate * kTick + 1e-9);
    yaw = now.yaw;
    pitch = now.pitch;
  }
  EXPECT_NEAR(yaw, 2.9, 1e-9);
  EXPECT_NEAR(pitch, -1.2, 1e-9);
}

TEST(SimulatedRobot, ACylinderPassesUnderATableThatAHigherOneMeets) {
  Mesh mesh;
  test::AddBox(mesh, {Eigen::Vector3d(1.0, -2.0, 0.60), Eigen::Vector3d(2.0, 2.0, 0.63)});
  // low enough to drive over
  test::AddBox(mesh, {Eigen::Vector3d(3.0, -2.0, 0.0), Eigen::Vector3d(4.0, 2.0, 0.14)});
  test::AddBox(mesh, {Eigen::Vector3d(5.0, -2.0, 0.0), Eigen::Vector3d(6.0, 2.0, 0.16)});
  const World world(mesh, kFlightBounds);
  for (const double height : {0.4, 0.6}) {
    SimulatedRobot robot(world, {.radius = 0.17, .height = height, .drives = true}, At(0.0, 0.0, 0.35));
    Drive(robot, At(9.0, 0.0, 0.35), 30.0);
    const double obstacle = height < 0.5 ? 5.0 : 1.0;
    EXPECT_NEAR(robot.T_WB().translation().x(), obstacle - 0.17, 2.0 * SimulatedRobot::kContact) << height;
    EXPECT_EQ(robot.collisions(), 1U);
  }
}

TEST(SimulatedRobot, StandsAtContactAndLeavesItAgain) {
  const World world = Sheet();
  SimulatedRobot robot(world, {}, At(0.5));
  Drive(robot, At(2.0), 3.0);
  EXPECT_EQ(robot.collisions(), 1U);
  EXPECT_LE(robot.clearance(), SimulatedRobot::kContact);
  Drive(robot, At(0.5), 3.0);
  EXPECT_NEAR(robot.T_WB().translation().x(), 0.5, 1e-9);
  EXPECT_EQ(robot.collisions(), 1U);
}

TEST(SimulatedRobot, CountsOneCollisionAContactNotOneAStep) {
  const World world = Sheet();
  SimulatedRobot robot(world, {}, At(0.5));
  Drive(robot, At(2.0), 4.0);
  EXPECT_EQ(robot.collisions(), 1U) << "pushing on is the same contact";
  Drive(robot, At(1.0 - RobotModel{}.radius - 0.005), 1.0);
  Drive(robot, At(2.0), 1.0);
  EXPECT_EQ(robot.collisions(), 1U) << "5 mm away is not clear of it";
  Drive(robot, At(0.8), 1.0);
  Drive(robot, At(2.0), 1.0);
  EXPECT_EQ(robot.collisions(), 2U);
}

TEST(SimulatedRobot, FliesAlongASurfaceCloseToItWithoutCollision) {
  const World world = Sheet();
  RobotModel model;
  SimulatedRobot robot(world, model, At(1.0 - model.radius - 5e-4));
  Drive(robot, At(1.0 - model.radius - 5e-4, 2.0), 5.0);
  EXPECT_NEAR(robot.T_WB().translation().y(), 2.0, 1e-6);
  EXPECT_EQ(robot.collisions(), 0U);
}

TEST(SimulatedRobot, KeepsItsSpeedAndTurnLimits) {
  const World world = Sheet();
  RobotModel model;
  SimulatedRobot robot(world, model, At(-5.0));
  const RigidTransform target = MakeTransform(RotationFromYawPitch(2.0, 0.3), {-7.0, 1.0, 0.5});
  RigidTransform before = robot.T_WB();
  double length = 0.0;
  for (int i = 0; i < 400; ++i) {
    robot.Command(target);
    robot.Step(kTick);
    const double step = (robot.T_WB().translation() - before.translation()).norm();
    ASSERT_LE(step, model.max_speed * kTick + 1e-12);
    ASSERT_LE(AngleBetween(before, robot.T_WB()), model.max_turn_rate * kTick + 1e-7);
    ASSERT_NEAR(robot.v_WB_B().norm(), step / kTick, 1e-9);
    length += step;
    before = robot.T_WB();
  }
  EXPECT_LT((robot.T_WB().translation() - target.translation()).norm(), 1e-9);
  EXPECT_LT(AngleBetween(robot.T_WB(), target), 1e-6);
  EXPECT_NEAR(robot.distance(), length, 1e-9);
  EXPECT_NEAR(robot.distance(), (target.translation() - At(-5.0).translation()).norm(), 1e-9);
}

TEST(SimulatedRobot, ReportsItsVelocityInItsOwnAxes) {
  const World world = Sheet();
  const double quarter = 0.5 * std::numbers::pi;
  const Eigen::Matrix3d left = RotationFromYawPitch(quarter, 0.0);
  SimulatedRobot robot(world, {}, MakeTransform(left, {-5, 0, 0}));
  robot.Command(MakeTransform(left, {-5, 3, 0}));
  robot.Step(kTick);
  EXPECT_LT((robot.v_WB_B() - Eigen::Vector3d(0.5, 0, 0)).norm(), 1e-9) << "forwards is along W's y";
  robot.Command(MakeTransform(RotationFromYawPitch(quarter + 1.0, 0.0), robot.T_WB().translation()));
  robot.Step(kTick);
  EXPECT_LT((robot.w_WB_B() - Eigen::Vector3d(0, 0, 1.6)).norm(), 1e-6);
}

TEST(SimulatedRobot, ForgetsACommandAfterItsLifespan) {
  const World world = Sheet();
  RobotModel model;
  for (const double dt : {0.01, 0.02, 5.0}) {
    SimulatedRobot robot(world, model, At(-40.0));
    robot.Command(At(0.0));
    for (double t = 0.0; t < 4.0; t += dt) robot.Step(dt);
    EXPECT_NEAR(robot.distance(), model.max_speed * SimulatedRobot::kCommandLifespan, 1e-9) << dt;
    EXPECT_EQ(robot.v_WB_B().norm() > 0.0, dt == 5.0);
  }
}

TEST(SimulatedRobot, KeepsItsLeastClearance) {
  const World world = Sheet();
  RobotModel model;
  SimulatedRobot robot(world, model, At(0.5));
  Drive(robot, At(0.7), 2.0);
  Drive(robot, At(0.0), 2.0);
  EXPECT_NEAR(robot.least_clearance(), 0.3 - model.radius, 1e-6);
  EXPECT_NEAR(robot.clearance(), 1.0 - model.radius, 1e-6);
}

TEST(SimulatedRobot, RefusesAStartInsideASurface) {
  const World world = Sheet();
  EXPECT_THROW(SimulatedRobot(world, {}, At(0.95)), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::simulator
