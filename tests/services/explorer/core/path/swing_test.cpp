#include "services/explorer/core/path/swing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/services/explorer/support/random_paths.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

using test::kClearance;
using test::kSize;
using Obstacles = PlanningMap::Obstacles;
using Points = std::vector<Eigen::Vector3d>;

constexpr double kSpeed = 2.0;         // [m/s]
constexpr double kAcceleration = 3.0;  // [m/s^2]

PlanningMap Room() {
  PlanningMap map({.voxel_size = kSize, .clearance = kClearance, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {99, 99, 20}}, VoxelState::kFree));
  return map;
}

Flight FlightAlongX(const Eigen::Vector3d& p_W, double speed = kSpeed) {
  return {p_W, {speed, 0.0, 0.0}, kSpeed, kAcceleration};
}

Eigen::Vector3d DirectionOf(const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W) {
  return (to_W - from_W).normalized();
}

TEST(Swing, TurnsARobotByConstantAccelerationTowardTheEnd) {
  const Points path_W = {{3.05, 3.05, 1.05}, {3.05, 9.05, 1.05}};
  const auto swing = SwingOnto(Room(), FlightAlongX({2.05, 3.05, 1.05}), path_W, kClearance);
  ASSERT_TRUE(swing);
  const Points& arc_W = swing->arc_W;
  ASSERT_GT(arc_W.size(), 20U);
  EXPECT_EQ(arc_W.front(), Eigen::Vector3d(2.05, 3.05, 1.05));
  EXPECT_EQ(swing->rest_W, Points{path_W.back()});
  EXPECT_GT(DirectionOf(arc_W[0], arc_W[1]).x(), 0.9995) << "begins as it flies";
  const Eigen::Vector3d straight_W = DirectionOf(arc_W.back(), path_W.back());
  EXPECT_GT(DirectionOf(arc_W.end()[-2], arc_W.back()).dot(straight_W), 0.9995) << "ends as it goes on";
  // From 2 m/s along x to 2 m/s along the straight, at nine tenths of 3 m/s^2.
  const double duration = (kSpeed * straight_W - Eigen::Vector3d(kSpeed, 0.0, 0.0)).norm() / 2.7;
  const double dt = duration / static_cast<double>(arc_W.size() - 1);
  for (std::size_t n = 1; n + 1 < arc_W.size(); ++n) {
    const Eigen::Vector3d a_W = (arc_W[n + 1] - 2.0 * arc_W[n] + arc_W[n - 1]) / (dt * dt);
    EXPECT_NEAR(a_W.norm(), 2.7, 1e-3);
  }
}

TEST(Swing, LeavesOutCornersOfThePathThatItNeedNotPass) {
  const Points path_W = {{3.05, 3.05, 1.05}, {3.05, 4.05, 1.05}, {4.05, 5.05, 1.05}, {8.05, 5.05, 1.05}};
  const auto swing = SwingOnto(Room(), FlightAlongX({2.05, 3.05, 1.05}), path_W, kClearance);
  ASSERT_TRUE(swing);
  EXPECT_EQ(swing->rest_W, Points{path_W.back()});
}

TEST(Swing, SlowsDownForAnEndThatIsNear) {
  const Points path_W = {{3.05, 3.05, 1.05}, {3.15, 3.75, 1.05}};
  const auto swing = SwingOnto(Room(), FlightAlongX({2.05, 3.05, 1.05}), path_W, kClearance);
  ASSERT_TRUE(swing);
  const Points& arc_W = swing->arc_W;
  const double straight = (path_W.back() - arc_W.back()).norm();
  const double dt = 0.03 / 2.7;  // at most, so that the speed is at least
  const double speed = (arc_W.back() - arc_W.end()[-2]).norm() / dt;
  EXPECT_LT(speed * speed, 2.0 * kAcceleration * straight) << "it can still stop there";
  EXPECT_LT(speed, 0.9 * kSpeed);
}

TEST(Swing, OfARobotThatFliesThereAlreadyIsAPoint) {
  const Eigen::Vector3d p_W(2.05, 3.05, 1.05);
  const Points path_W = {{3.05, 3.05, 1.05}, {9.05, 3.05, 1.05}};
  const auto swing = SwingOnto(Room(), FlightAlongX(p_W), path_W, kClearance);
  ASSERT_TRUE(swing);
  EXPECT_EQ(swing->arc_W, Points{p_W});
}

TEST(Swing, DoesNotTurnBack) {
  const Points path_W = {{5.05, 5.05, 1.05}, {1.05, 5.15, 1.05}};
  EXPECT_FALSE(SwingOnto(Room(), FlightAlongX({4.05, 5.05, 1.05}), path_W, kClearance));
}

TEST(Swing, IsNoneWhereAWallIsInTheWay) {
  PlanningMap map = Room();
  // At 2 m/s it needs 0.7 m to come to stand; a meter beside its way there is no more space, either.
  map.Apply(test::BoxOf({{46, 0, 0}, {47, 99, 20}}, VoxelState::kOccupied));
  const Points path_W = {{4.25, 5.05, 1.05}, {4.25, 9.05, 1.05}};
  EXPECT_FALSE(SwingOnto(map, FlightAlongX({4.15, 5.05, 1.05}), path_W, kClearance));
  EXPECT_TRUE(SwingOnto(map, FlightAlongX({2.05, 5.05, 1.05}), path_W, kClearance));
}

class SwingOnRandomMaps : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Seeds, SwingOnRandomMaps, testing::Range(1U, 9U));

TEST_P(SwingOnRandomMaps, KeepsTheClearanceFromItsBeginningToThePath) {
  std::mt19937 random(GetParam());
  PlanningMap map({.voxel_size = kSize, .clearance = kClearance, .bounds = {}});
  map.Apply(test::RandomScene(random, {{0, 0, 0}, {60, 60, 20}}, 12, 8));
  const std::vector<VoxelIndex> traversable = test::TraversableVoxels(map);
  ASSERT_GT(traversable.size(), 50U);
  int swings = 0;
  for (int n = 0; n < 60; ++n) {
    const Points path_W = test::RandomPath(random, map, traversable);
    if (path_W.size() < 2) continue;
    const Eigen::Vector3d& from_W = path_W.front();
    const double angle = test::RandomDouble(random, -3.0, 3.0);
    const double speed = test::RandomDouble(random, 0.1, kSpeed);
    const Eigen::Vector3d v_W(speed * std::cos(angle), speed * std::sin(angle), 0.0);
    const auto swing = SwingOnto(map, {from_W, v_W, kSpeed, kAcceleration}, path_W, kClearance);
    if (!swing) continue;
    ++swings;
    EXPECT_EQ(swing->arc_W.front(), from_W);
    EXPECT_EQ(swing->rest_W.back(), path_W.back());
    Points swung_W = swing->arc_W;
    swung_W.push_back(swing->rest_W.front());
    EXPECT_GE(test::SampledClearance(map, swung_W, Obstacles::kOccupiedAndUnknown, kClearance),
              kClearance - 1e-3);
  }
  EXPECT_GT(swings, 5);
}

}  // namespace
}  // namespace thalweg::explorer
