#include "services/explorer/core/path/home_paths.h"

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

TEST(HomePaths, IsAsLongAsTheShortestPath) {
  const PlanningMap map = RoomsSideBySide();
  HomePaths home_paths({});
  home_paths.SetOut(kHome_W);
  home_paths.Find(map, kHome_W);
  EXPECT_NEAR(home_paths.LengthFrom(map, {2.55, 0.55, 0.65}).value(), 2.0, 1e-9);
  EXPECT_NEAR(home_paths.Needed(2.0), 1.15 * 2.0 + 0.5, 1e-12);
}

TEST(HomePaths, FromATightPlaceItDoesNotLeadThroughTheWall) {
  const PlanningMap map = RoomsSideBySide();
  for (const double wide : {0.3, 1.0}) {
    HomePaths home_paths({.exemption = 0.3, .wide_exemption = wide});
    home_paths.SetOut(kHome_W);
    home_paths.Find(map, kHome_W);
    const Eigen::Vector3d behind_the_wall(0.55, 1.16, 0.65);
    ASSERT_FALSE(map.Traversable(map.IndexOf(behind_the_wall)));
    EXPECT_GT(home_paths.LengthFrom(map, behind_the_wall).value(), 6.0);
  }
}

TEST(HomePaths, AHomeThatTheRobotCouldNotSeeAroundIsReachedFromFurtherOff) {
  // A driving robot knows nothing within 0.5 m of its start, except for the layer of its camera.
  PlanningMap map({.voxel_size = 0.1, .clearance = 0.15, .half_height = 0.2, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {40, 21, 12}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{5, 5, 0}, {16, 16, 3}}, VoxelState::kUnknown));
  map.SetPlane(0.35);
  HomePaths home_paths({.exemption = 0.3, .wide_exemption = 1.0});
  home_paths.SetOut({1.05, 1.05, 0.35});
  home_paths.Find(map, {3.05, 1.05, 0.35});
  const auto length = home_paths.LengthFrom(map, {3.05, 1.05, 0.35});
  ASSERT_TRUE(length);
  EXPECT_NEAR(*length, 2.0, 0.1);
}

TEST(HomePaths, ThePathToATightHomeIsTheShortestOfThoseToItsSurroundings) {
  // Home is too near to the wall across, so the robot may have left it for any of many voxels.
  const PlanningMap map = RoomsSideBySide();
  const Eigen::Vector3d home_W(1.05, 1.16, 0.65);
  ASSERT_FALSE(map.Traversable(map.IndexOf(home_W)));
  HomePaths home_paths({});
  home_paths.SetOut(home_W);
  for (const Eigen::Vector3d& p_W : {Eigen::Vector3d(3.05, 1.55, 0.65), Eigen::Vector3d(0.35, 1.75, 0.65),
                                     Eigen::Vector3d(2.05, 0.55, 0.35)}) {
    home_paths.Find(map, p_W);
    const std::vector<Eigen::Vector3d> path_W = home_paths.PathFrom(map, p_W);
    ASSERT_GE(path_W.size(), 2U);
    EXPECT_EQ(path_W.front(), p_W);
    EXPECT_EQ(path_W.back(), home_W);
    double length = 0.0;
    for (std::size_t k = 1; k < path_W.size(); ++k) length += (path_W[k] - path_W[k - 1]).norm();
    EXPECT_NEAR(length, home_paths.LengthFrom(map, p_W).value(), 0.02 * length);
  }
}

TEST(HomePaths, ThereIsNoneWithoutAConnection) {
  PlanningMap map = RoomsSideBySide();
  map.Apply(test::BoxOf({{35, 10, 0}, {40, 11, 12}}, VoxelState::kOccupied));
  HomePaths home_paths({});
  home_paths.SetOut(kHome_W);
  home_paths.Find(map, kHome_W);
  EXPECT_FALSE(home_paths.LengthFrom(map, {2.05, 1.55, 0.65}));
  EXPECT_TRUE(home_paths.PathFrom(map, {2.05, 1.55, 0.65}).empty());
}

}  // namespace
}  // namespace thalweg::explorer
