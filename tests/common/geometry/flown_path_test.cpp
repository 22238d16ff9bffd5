#include "common/geometry/flown_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "common/geometry/polyline.h"

namespace thalweg {
namespace {

RigidTransform LevelAt(double x, double y = 0.0, double yaw = 0.0) {
  return MakeTransform(RotationFromYawPitch(yaw, 0.0), {x, y, 0.0});
}

double DistanceTo(const std::vector<RigidTransform>& path, const Eigen::Vector3d& p_W) {
  double nearest = (path.front().translation() - p_W).norm();
  for (std::size_t k = 1; k < path.size(); ++k) {
    nearest = std::min(nearest, DistanceToSegment(path[k - 1].translation(), path[k].translation(), p_W));
  }
  return nearest;
}

TEST(FlownPath, AStraightLineIsASegment) {
  FlownPath flown;
  for (int k = 0; k <= 100; ++k) flown.Note(LevelAt(0.02 * k));
  EXPECT_EQ(flown.size(), 1U);
  EXPECT_DOUBLE_EQ(flown.end(), 2.0);
  const auto back = flown.BackTo(0.0);
  ASSERT_EQ(back.size(), 3U) << "the last of them twice";
  EXPECT_TRUE(back.front().isApprox(LevelAt(2.0)));
  EXPECT_TRUE(back.back().isApprox(LevelAt(0.0)));
}

TEST(FlownPath, NoPoseOfARandomFlightIsFartherFromItThanTheTolerance) {
  std::mt19937 random(7);
  std::normal_distribution<double> bend(0.0, 0.15);
  FlownPath flown;
  std::vector<RigidTransform> poses;
  double heading = 0.0;
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  for (int k = 0; k < 5000; ++k) {
    poses.push_back(MakeTransform(RotationFromYawPitch(heading, 0.0), p_W));
    flown.Note(poses.back());
    heading += bend(random);
    p_W += 0.01 * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.3 * std::sin(7.0 * heading));
  }
  const auto back = flown.BackTo(0.0);
  EXPECT_LT(back.size(), poses.size() / 2);
  for (const RigidTransform& T_WB : poses) EXPECT_LE(DistanceTo(back, T_WB.translation()), 0.011);
  EXPECT_NEAR(PathLength(back), flown.end(), 1e-9);
}

TEST(FlownPath, TurnsAreRetracedInSmallSteps) {
  FlownPath flown;
  for (int k = 0; k <= 90; ++k) flown.Note(LevelAt(0.0, 0.0, 0.03 * k));
  flown.Note(LevelAt(0.1, 0.0, 2.7));
  const auto back = flown.BackTo(0.0);
  ASSERT_GE(back.size(), 13U);
  for (std::size_t k = 1; k < back.size(); ++k) {
    EXPECT_LE(AngleBetween(back[k - 1], back[k]), FlownPath::kTurn + 1e-9);
  }
}

TEST(FlownPath, LeadsBackToAnyArcLengthAndForgetsWhatWasGoneBack) {
  FlownPath flown;
  for (int k = 0; k <= 50; ++k) flown.Note(LevelAt(0.02 * k));
  for (int k = 0; k <= 50; ++k) flown.Note(LevelAt(1.0, 0.02 * k));
  EXPECT_NEAR(flown.end(), 2.0, 0.02);
  const auto back = flown.BackTo(0.5);
  EXPECT_TRUE(back.front().isApprox(LevelAt(1.0, 1.0)));
  EXPECT_NEAR((back.back().translation() - Eigen::Vector3d(0.5, 0.0, 0.0)).norm(), 0.0, 0.02);
  EXPECT_NEAR(PathLength(back), 1.5, 0.02);
  flown.Shorten(0.5);
  EXPECT_NEAR(flown.end(), 0.5, 1e-9);
  for (int k = 0; k <= 50; ++k) flown.Note(LevelAt(0.5, -0.02 * k));
  EXPECT_NEAR(flown.end(), 1.5, 0.02);
  EXPECT_LT(DistanceTo(flown.BackTo(0.0), {0.5, -0.5, 0.0}), 0.02);
  EXPECT_GT(DistanceTo(flown.BackTo(0.0), {1.0, 0.5, 0.0}), 0.4);
}

TEST(FlownPath, NobodyKnowsTheWayToWhereTheRobotWasBeforeItsPoseLeapt) {
  FlownPath flown;
  for (int k = 0; k <= 50; ++k) flown.Note(LevelAt(0.02 * k));
  flown.Note(LevelAt(1.0 + 1.01 * FlownPath::kLeap));
  flown.Note(LevelAt(2.0));
  EXPECT_NEAR(flown.BackTo(0.0).back().translation().x(), 1.505, 1e-9);
}

TEST(FlownPath, IsBoundedHoweverLongTheFlight) {
  FlownPath flown;
  for (std::size_t k = 0; k < FlownPath::kMostPoses + 1000; ++k)
    flown.Note(LevelAt(0.1 * static_cast<double>(k % 2)));
  EXPECT_EQ(flown.size(), FlownPath::kMostPoses);
  EXPECT_GT(flown.begin(), 90.0);
  EXPECT_NEAR(PathLength(flown.BackTo(0.0)), flown.end() - flown.begin(), 1e-6);
}

TEST(FlownPath, OfARobotThatHasNotBeenAnywhereIsEmpty) {
  FlownPath flown;
  EXPECT_TRUE(flown.BackTo(0.0).empty());
  flown.Shorten(0.0);
  flown.Note(LevelAt(1.0));
  EXPECT_EQ(flown.end(), 0.0);
  EXPECT_NEAR(PathLength(flown.BackTo(5.0)), 0.0, 1e-12);
}

}  // namespace
}  // namespace thalweg
