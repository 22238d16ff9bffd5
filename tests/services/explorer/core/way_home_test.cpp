#include "services/explorer/core/way_home.h"

#include <gtest/gtest.h>

#include "tests/services/explorer/core/random_planning_map.h"

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
  way_home.Find(map);
  EXPECT_NEAR(way_home.LengthFrom(map, {2.55, 0.55, 0.65}).value(), 2.0, 1e-9);
  EXPECT_NEAR(way_home.Needed(2.0), 1.15 * 2.0 + 0.5, 1e-12);
}

TEST(WayHome, FromATightPlaceItDoesNotLeadThroughTheWall) {
  const PlanningMap map = RoomsSideBySide();
  for (const double wide : {0.3, 1.0}) {
    WayHome way_home({.exemption = 0.3, .wide_exemption = wide});
    way_home.SetOut(kHome_W);
    way_home.Find(map);
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
  way_home.Find(map);
  const auto length = way_home.LengthFrom(map, {3.05, 1.05, 0.35});
  ASSERT_TRUE(length);
  EXPECT_NEAR(*length, 2.0, 0.1);
}

TEST(WayHome, ThereIsNoneWithoutAConnection) {
  PlanningMap map = RoomsSideBySide();
  map.Apply(test::BoxOf({{35, 10, 0}, {40, 11, 12}}, VoxelState::kOccupied));
  WayHome way_home({});
  way_home.SetOut(kHome_W);
  way_home.Find(map);
  EXPECT_FALSE(way_home.LengthFrom(map, {2.05, 1.55, 0.65}));
}

}  // namespace
}  // namespace thalweg::explorer
