#include "services/explorer/core/path/way_home.h"

#include <gtest/gtest.h>

#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

const Eigen::Vector3d kHome_W(0.55, 0.55, 0.65);

/// 4 x 2.1 x 1.2 m, with a wall across at y = 1 m that leaves a gap at the far end, x > 3.5 m.
PlanningMap RoomsSideBySide() {
  PlanningMap map({.voxel_size = 0.1, .clearance = 0.15, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {40, 21, 12}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{0, 10, 0}, {35, 11, 12}}, VoxelState::kOccupied));
  return map;
}

TEST(WayHome, IsAsLongAsTheShortestPath) {
  const PlanningMap map = RoomsSideBySide();
  WayHome way_home({});
  way_home.SetOut(kHome_W);
  way_home.Find(map, kHome_W);
  EXPECT_NEAR(way_home.LengthFrom(map, {2.55, 0.55, 0.65}).value(), 2.0, 1e-9);
  EXPECT_NEAR(way_home.Needed(2.0), 1.15 * 2.0 + 0.5, 1e-12);
}

TEST(WayHome, FromATightPlaceItDoesNotLeadThroughTheWall) {
  const PlanningMap map = RoomsSideBySide();
  for (const double wide : {0.3, 1.0}) {
    WayHome way_home({.exemption = 0.3, .wide_exemption = wide});
    way_home.SetOut(kHome_W);
    way_home.Find(map, kHome_W);
    const Eigen::Vector3d behind_the_wall(0.55, 1.16, 0.65);
    ASSERT_FALSE(map.Traversable(map.IndexOf(behind_the_wall)));
    EXPECT_GT(way_home.LengthFrom(map, behind_the_wall).value(), 6.0);
  }
}

TEST(WayHome, AHomeThatTheRobotCouldNotSeeAroundIsReachedFromFurtherOff) {
  // A robot that drives knows nothing within 0.5 m of where it woke up, but for the layer of its camera.
  PlanningMap map({.voxel_size = 0.1, .clearance = 0.15, .half_height = 0.2, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {40, 21, 12}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{5, 5, 0}, {16, 16, 3}}, VoxelState::kUnknown));
  map.SetPlane(0.35);
  WayHome way_home({.exemption = 0.3, .wide_exemption = 1.0});
  way_home.SetOut({1.05, 1.05, 0.35});
  way_home.Find(map, {3.05, 1.05, 0.35});
  const auto length = way_home.LengthFrom(map, {3.05, 1.05, 0.35});
  ASSERT_TRUE(length);
  EXPECT_NEAR(*length, 2.0, 0.1);
}

TEST(WayHome, ThePathToATightHomeIsTheShortestOfThoseToItsSurroundings) {
  // Home is too near to the wall across: from the start the robot left it for any of many voxels.
  const PlanningMap map = RoomsSideBySide();
  const Eigen::Vector3d home_W(1.05, 1.16, 0.65);
  ASSERT_FALSE(map.Traversable(map.IndexOf(home_W)));
  WayHome way_home({});
  way_home.SetOut(home_W);
  for (const Eigen::Vector3d& p_W : {Eigen::Vector3d(3.05, 1.55, 0.65), Eigen::Vector3d(0.35, 1.75, 0.65),
                                     Eigen::Vector3d(2.05, 0.55, 0.35)}) {
    way_home.Find(map, p_W);
    const std::vector<Eigen::Vector3d> path_W = way_home.PathFrom(map, p_W);
    ASSERT_GE(path_W.size(), 2U);
    EXPECT_EQ(path_W.front(), p_W);
    EXPECT_EQ(path_W.back(), home_W);
    double length = 0.0;
    for (std::size_t k = 1; k < path_W.size(); ++k) length += (path_W[k] - path_W[k - 1]).norm();
    EXPECT_NEAR(length, way_home.LengthFrom(map, p_W).value(), 0.02 * length);
  }
}

TEST(WayHome, ThereIsNoneWithoutAConnection) {
  PlanningMap map = RoomsSideBySide();
  map.Apply(test::BoxOf({{35, 10, 0}, {40, 11, 12}}, VoxelState::kOccupied));
  WayHome way_home({});
  way_home.SetOut(kHome_W);
  way_home.Find(map, kHome_W);
  EXPECT_FALSE(way_home.LengthFrom(map, {2.05, 1.55, 0.65}));
  EXPECT_TRUE(way_home.PathFrom(map, {2.05, 1.55, 0.65}).empty());
}

}  // namespace
}  // namespace thalweg::explorer
