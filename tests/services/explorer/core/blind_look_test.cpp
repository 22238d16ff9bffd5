#include "services/explorer/core/blind_look.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace thalweg::explorer {
namespace {

/// All directions in which it looks, from the heading along x.
std::vector<Eigen::Vector3d> Directions(BlindLook& look, Attitude attitude) {
  std::vector<Eigen::Vector3d> directions;
  Eigen::Matrix3d R_WB = Eigen::Matrix3d::Identity();
  while (const std::optional<Eigen::Matrix3d> next = look.Next(R_WB, {.attitude = attitude})) {
    R_WB = *next;
    directions.emplace_back(R_WB.col(0));
  }
  return directions;
}

TEST(BlindLook, ALevelRobotTurnsOnceRound) {
  BlindLook look;
  const std::vector<Eigen::Vector3d> directions = Directions(look, Attitude::kLevel);
  ASSERT_EQ(directions.size(), 6U);
  for (std::size_t n = 0; n < directions.size(); ++n) {
    const double yaw = (static_cast<double>(n) + 1.0) * std::numbers::pi / 3.0;
    EXPECT_TRUE(directions[n].isApprox(Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0), 1e-9)) << n;
  }
}

TEST(BlindLook, OthersLookDownAndUpAsWell) {
  BlindLook look;
  const std::vector<Eigen::Vector3d> directions = Directions(look, Attitude::kFree);
  ASSERT_EQ(directions.size(), 18U);
  const double slope = std::sin(0.25 * std::numbers::pi);
  for (std::size_t n = 0; n < directions.size(); ++n) {
    const double expected = n < 6 ? 0.0 : slope;
    EXPECT_NEAR(std::abs(directions[n].z()), expected, 1e-9) << n;
  }
  EXPECT_NEAR(directions[6].z(), -directions[12].z(), 1e-9);
}

TEST(BlindLook, OneWithAGimbalLooksUpAsFarAsItGoes) {
  BlindLook look;
  const std::vector<Eigen::Vector3d> directions = Directions(look, Attitude::kGimbal);
  ASSERT_EQ(directions.size(), 24U);
  EXPECT_NEAR(directions[0].z(), 0.0, 1e-9);
  EXPECT_NEAR(directions[6].z(), std::sin(RobotModel{}.gimbal_highest), 1e-9);
  EXPECT_NEAR(directions[12].z(), -std::sin(0.25 * std::numbers::pi), 1e-9);
  EXPECT_NEAR(directions[18].z(), std::sin(RobotModel{}.gimbal_lowest), 1e-9);
}

TEST(BlindLook, BeginsAgainOnceFreeSpaceWasKnown) {
  BlindLook look;
  EXPECT_EQ(Directions(look, Attitude::kLevel).size(), 6U);
  EXPECT_FALSE(look.Next(Eigen::Matrix3d::Identity(), {.attitude = Attitude::kLevel}));
  look.Reset();
  EXPECT_EQ(Directions(look, Attitude::kLevel).size(), 6U);
}

}  // namespace
}  // namespace thalweg::explorer
