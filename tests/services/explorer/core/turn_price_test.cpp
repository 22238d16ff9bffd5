#include "services/explorer/core/turn_price.h"

#include <gtest/gtest.h>

#include <numbers>

#include "common/base/angles.h"
#include "tests/services/explorer/support/random_planning_map.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

constexpr double kPi = std::numbers::pi;

const PinholeCamera kSquare = PinholeCamera::FromFieldOfView(100, 100, 90.0 * kDegree);
const PinholeCamera kWide = PinholeCamera::FromFieldOfView(200, 100, 90.0 * kDegree);

TEST(AngleWellInView, IsTwoThirdsOfTheNearerSideThatTheRobotCanTurnTo) {
  RobotModel robot;
  EXPECT_NEAR(AngleWellInView(kSquare, robot), 30.0 * kDegree, 1e-12);
  EXPECT_NEAR(AngleWellInView(kWide, robot), 2.0 / 3.0 * std::atan(0.5), 1e-12) << "its top is nearer";
  robot.attitude = Attitude::kLevel;
  EXPECT_NEAR(AngleWellInView(kWide, robot), 30.0 * kDegree, 1e-12) << "it turns sideways only";
}

/// Free space in which a robot stands at kHere, looking along x; a candidate lies 1 m along some direction
/// from a goal.
class PriceOfTurnTest : public testing::Test {
 protected:
  static constexpr VoxelIndex kHere{0, 0, 0};

  PriceOfTurnTest() { map_.Apply(test::BoxOf({{-40, -40, -40}, {41, 41, 41}}, VoxelState::kFree)); }

  double Price(const VoxelIndex& goal, const Eigen::Vector3d& sight_W, double length) const {
    Candidate candidate;
    candidate.goals = {goal};
    candidate.cluster.center_W = map_.CenterOf(goal) + sight_W;
    candidate.length = length;
    const RigidTransform T_WB = MakeTransform(Eigen::Matrix3d::Identity(), map_.CenterOf(kHere));
    return PriceOfTurn(candidate.goals.front(), candidate.length, candidate.cluster.center_W, T_WB, map_,
                       kSquare, robot_);
  }
  /// [m] That the robot travels at half its speed while it turns by `angle`, after it got up to its rate.
  double Travel(double angle) const {
    const double time = angle / robot_.max_turn_rate + robot_.max_turn_rate / robot_.max_turn_acceleration;
    return 0.5 * robot_.max_speed * time;
  }

  PlanningMap map_{{.voxel_size = 0.1, .clearance = 0.15, .bounds = {}}};
  RobotModel robot_;
};

TEST_F(PriceOfTurnTest, WhatIsWellInViewCostsNothing) {
  const double inside = 29.0 * kDegree;
  EXPECT_EQ(Price(kHere, {1, 0, 0}, 0.0), 0.0);
  EXPECT_EQ(Price(kHere, {std::cos(inside), 0.0, std::sin(inside)}, 0.0), 0.0);
}

TEST_F(PriceOfTurnTest, IsTheTravelInTheTimeOfTheTurnThatThePathDoesNotTake) {
  const double behind = Travel(kPi - 30.0 * kDegree);
  EXPECT_NEAR(Price(kHere, {-1, 0, 0}, 0.0), behind, 1e-9);
  EXPECT_NEAR(Price(kHere, {0, 1, 0}, 0.0), Travel(60.0 * kDegree), 1e-9);
  EXPECT_NEAR(Price({2, 0, 0}, {-1, 0, 0}, 0.2), behind - 0.2, 1e-9) << "it turns while it travels";
  EXPECT_EQ(Price({20, 0, 0}, {-1, 0, 0}, 2.0), 0.0);
}

TEST_F(PriceOfTurnTest, ALevelRobotDoesNotTurnUpwards) {
  robot_.attitude = Attitude::kLevel;
  EXPECT_EQ(Price(kHere, {0, 0, 1}, 0.0), 0.0);
  EXPECT_NEAR(Price(kHere, {0, 1, 5}, 0.0), Travel(60.0 * kDegree), 1e-9);
}

TEST_F(PriceOfTurnTest, ToANarrowPlaceItFacesItsWayFirst) {
  constexpr VoxelIndex kGoal{0, 5, 0};  // to the left
  EXPECT_NEAR(Price(kGoal, {1, 0, 0}, 0.1), 0.0, 1e-9) << "in the open it goes there sideways";
  // 0.05 m from its center to the cube: less than its radius and a voxel.
  map_.Apply(test::BoxOf({{0, 6, 0}, {1, 7, 1}}, VoxelState::kOccupied));
  EXPECT_NEAR(Price(kGoal, {1, 0, 0}, 0.1), Travel(0.5 * kPi) + Travel(60.0 * kDegree) - 0.1, 1e-9);
}

}  // namespace
}  // namespace thalweg::explorer
