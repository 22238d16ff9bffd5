#include "services/explorer/core/path/path_comfort.h"

#include <gtest/gtest.h>

#include "services/explorer/core/path/path_search.h"
#include "tests/services/explorer/support/random_paths.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

using test::kClearance;
using test::kSize;
using Obstacles = PlanningMap::Obstacles;

constexpr PathComfort kComfort{.distance = 0.1, .reach = 0.35, .price = 3.0};

double ClearanceOf(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W) {
  return test::SampledClearance(map, path_W, Obstacles::kOccupiedAndUnknown, 1.0);
}

TEST(PathComfort, APathAlongAWallIsLedOffIt) {
  PlanningMap map({.voxel_size = kSize, .clearance = kClearance, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {60, 20, 20}}, VoxelState::kFree));
  const std::vector<Eigen::Vector3d> along_W = {{1.05, 0.15, 1.05}, {4.95, 0.15, 1.05}};
  const std::vector<Eigen::Vector3d> led_W = MakeComfortable(map, along_W, kComfort);
  EXPECT_EQ(led_W.front(), along_W.front());
  EXPECT_EQ(led_W.back(), along_W.back());
  ASSERT_GE(led_W.size(), 3U);
  // Except at its ends, the path keeps the comfort distance; that costs only a voxel to the side and back.
  for (std::size_t n = 1; n + 1 < led_W.size(); ++n)
    EXPECT_GE(led_W[n].y(), kClearance + kComfort.distance - 1e-6);
  EXPECT_LT(PathLength(led_W), PathLength(along_W) + 0.21);
}

TEST(PathComfort, ACorridorWithoutRoomIsGoneThroughAsItIs) {
  PlanningMap map({.voxel_size = kSize, .clearance = kClearance, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {60, 3, 3}}, VoxelState::kFree));
  const std::vector<Eigen::Vector3d> path_W = {{0.45, 0.15, 0.15}, {5.05, 0.15, 0.15}};
  EXPECT_EQ(MakeComfortable(map, path_W, kComfort), path_W);
}

TEST(PathComfort, APathThatHasRoomStaysStraight) {
  PlanningMap map({.voxel_size = kSize, .clearance = kClearance, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {60, 20, 20}}, VoxelState::kFree));
  const std::vector<Eigen::Vector3d> path_W = {{0.55, 1.05, 1.05}, {5.05, 1.45, 0.65}};
  EXPECT_EQ(MakeComfortable(map, path_W, kComfort), path_W);
}

TEST(PathComfort, ARobotTooNearToAWallLeavesItAsItWasTold) {
  PlanningMap map({.voxel_size = kSize, .clearance = kClearance, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {60, 20, 20}}, VoxelState::kFree));
  const std::vector<Eigen::Vector3d> path_W = {{1.0, 0.08, 1.0}, {1.05, 0.25, 1.05}, {4.95, 0.25, 1.05}};
  const std::vector<Eigen::Vector3d> led_W = MakeComfortable(map, path_W, kComfort);
  EXPECT_EQ(led_W[0], path_W[0]);
  EXPECT_EQ(led_W[1], path_W[1]);
}

TEST(PathComfort, NoneAskedForIsNoneGiven) {
  PlanningMap map({.voxel_size = kSize, .clearance = kClearance, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {60, 20, 20}}, VoxelState::kFree));
  const std::vector<Eigen::Vector3d> along_W = {{1.05, 0.15, 1.05}, {4.95, 0.15, 1.05}};
  EXPECT_EQ(MakeComfortable(map, along_W, {.distance = 0.0}), along_W);
}

/// Free space on both sides of a wall of two voxels with a square hole in it.
PlanningMap WallWithAHole(int edge, double clearance) {
  PlanningMap map({.voxel_size = kSize, .clearance = clearance, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {20, 20, 20}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{22, 0, 0}, {42, 20, 20}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{20, 8, 8}, {22, 8 + edge, 8 + edge}}, VoxelState::kFree));
  return map;
}

/// Through the hole, from center to center of voxels.
std::vector<Eigen::Vector3d> ThroughHole() {
  std::vector<Eigen::Vector3d> path_W;
  for (int x = 12; x < 30; ++x) path_W.emplace_back((x + 0.5) * kSize, 0.95, 0.95);
  return path_W;
}

TEST(PathComfort, AWiderPathGoesThroughTheMiddleOfAGapWhereNoVoxelHasItsCenter) {
  const PlanningMap map = WallWithAHole(4, 0.2);  // centers of voxels keep 0.15 m from a side
  const std::vector<Eigen::Vector3d> path_W = ThroughHole();
  ASSERT_FALSE(map.Traversable(map.IndexOf({2.05, 0.95, 0.95})));
  for (const double distance : {0.0, 0.1}) {
    const std::vector<Eigen::Vector3d> wider_W =
        FindWiderPath(map, path_W, 0.2, {.distance = distance, .reach = 0.35, .price = 3.0});
    ASSERT_FALSE(wider_W.empty());
    EXPECT_EQ(wider_W.front(), path_W.front());
    EXPECT_LE((wider_W.back() - path_W.back()).cwiseAbs().maxCoeff(), 0.5 * kSize + 1e-9);
    EXPECT_GE(ClearanceOf(map, wider_W), 0.2 - 1e-6);
    EXPECT_LT(PathLength(wider_W), PathLength(path_W) + 0.5);
  }
}

TEST(PathComfort, WhereTheGapIsNarrowerThereIsNoWiderPath) {
  EXPECT_TRUE(FindWiderPath(WallWithAHole(3, 0.2), ThroughHole(), 0.2, kComfort).empty());
  EXPECT_FALSE(FindWiderPath(WallWithAHole(3, 0.2), ThroughHole(), 0.15, kComfort).empty());
  EXPECT_TRUE(FindWiderPath(WallWithAHole(3, 0.2), ThroughHole(), 0.16, kComfort).empty());
}

TEST(PathComfort, AWiderPathStaysWithinTheBoundsAndOutOfNoGoBoxes) {
  const std::vector<Eigen::Vector3d> path_W = ThroughHole();
  PlanningMap map = WallWithAHole(4, 0.2);
  map.SetNoGo({{Eigen::Vector3d(2.05, 0.85, 0.85), Eigen::Vector3d(2.15, 0.88, 0.88)}});
  EXPECT_TRUE(FindWiderPath(map, path_W, 0.2, kComfort).empty());
  // The hole's middle is above the bounds, within which a body would touch its lower side.
  std::vector<Eigen::Vector3d> lower_W = path_W;
  for (Eigen::Vector3d& p_W : lower_W) p_W.z() = 0.85;
  for (const double top : {0.9, 1.6}) {
    PlanningMap bounded(
        {.voxel_size = kSize,
         .clearance = 0.2,
         .bounds = Eigen::AlignedBox3d(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(4.2, 2, top))});
    bounded.Apply(test::BoxOf({{0, 0, 0}, {42, 20, 20}}, VoxelState::kFree));
    bounded.Apply(test::BoxOf({{20, 0, 0}, {22, 20, 8}}, VoxelState::kOccupied));
    EXPECT_EQ(FindWiderPath(bounded, lower_W, 0.2, kComfort).empty(), top < 1.0) << top;
  }
}

TEST(PathComfort, ARobotThatDrivesStaysInItsPlaneOnAWiderPath) {
  PlanningMap map({.voxel_size = kSize, .clearance = 0.2, .half_height = 0.2, .bounds = {}});
  map.SetPlane(1.0);
  map.Apply(test::BoxOf({{0, 0, 0}, {20, 20, 20}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{22, 0, 0}, {42, 20, 20}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{20, 8, 0}, {22, 12, 20}}, VoxelState::kFree));
  std::vector<Eigen::Vector3d> path_W = ThroughHole();
  for (Eigen::Vector3d& p_W : path_W) p_W.z() = map.CenterOf(map.IndexOf({0.0, 0.0, 1.0})).z();
  const std::vector<Eigen::Vector3d> wider_W = FindWiderPath(map, path_W, 0.2, kComfort);
  ASSERT_FALSE(wider_W.empty());
  for (const Eigen::Vector3d& p_W : wider_W) EXPECT_EQ(map.IndexOf(p_W).z, map.IndexOf(path_W[0]).z);
}

class PathComfortOnRandomMaps : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Seeds, PathComfortOnRandomMaps, testing::Range(1U, 9U));

TEST_P(PathComfortOnRandomMaps, KeepsEndsAndClearanceAndComesNoNearerThanTheShortestPath) {
  std::mt19937 random(GetParam());
  PlanningMap map({.voxel_size = kSize, .clearance = 0.1, .bounds = {}});
  map.Apply(test::RandomScene(random, {{0, 0, 0}, {24, 24, 16}}, 18, 6));
  const std::vector<VoxelIndex> traversable = test::TraversableVoxels(map);
  ASSERT_GT(traversable.size(), 50U);
  double worse = 0.0;
  double better = 0.0;
  for (int n = 0; n < 30; ++n) {
    const std::vector<Eigen::Vector3d> path_W = test::RandomPath(random, map, traversable);
    if (path_W.empty()) continue;
    const std::vector<Eigen::Vector3d> led_W = MakeComfortable(map, path_W, kComfort);
    EXPECT_EQ(led_W.front(), path_W.front());
    EXPECT_EQ(led_W.back(), path_W.back());
    EXPECT_GE(ClearanceOf(map, led_W), 0.1 - kSize / 8 - 0.001);
    // Longer by no more than the price allows.
    EXPECT_LE(PathLength(led_W), (1.0 + kComfort.price) * PathLength(path_W) * 1.1 + 1e-9);
    const auto length_within = [&](const std::vector<Eigen::Vector3d>& line_W) {
      double near = 0.0;  // [m] length with less than the comfort distance
      for (std::size_t k = 1; k < line_W.size(); ++k) {
        for (int piece = 0; piece < 50; ++piece) {
          const Eigen::Vector3d p_W = line_W[k - 1] + (line_W[k] - line_W[k - 1]) * ((piece + 0.5) / 50.0);
          const bool too_near = map.ClearanceAt(p_W, Obstacles::kOccupiedAndUnknown, 0.3) < 0.2 - 1e-6;
          near += too_near ? (line_W[k] - line_W[k - 1]).norm() / 50.0 : 0.0;
        }
      }
      return near;
    };
    worse += length_within(path_W);
    better += length_within(led_W);
  }
  EXPECT_LE(better, worse);
}

}  // namespace
}  // namespace thalweg::explorer
