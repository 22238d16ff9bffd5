#include "services/explorer/core/path/flyable_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/polyline.h"
#include "tests/services/explorer/support/random_paths.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

using test::kClearance;
using test::kSize;
using Obstacles = PlanningMap::Obstacles;
using Points = std::vector<Eigen::Vector3d>;

constexpr double kKeep = 0.25;

PlanningMap OpenSpace() {
  PlanningMap map({.voxel_size = kSize, .clearance = kClearance, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {60, 60, 20}}, VoxelState::kFree));
  return map;
}

/// [m] The least radius of a curve through a polyline: mean length of two segments / angle between them.
double LeastRadius(const Points& path_W) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t n = 1; n + 1 < path_W.size(); ++n) {
    const Eigen::Vector3d a = path_W[n] - path_W[n - 1];
    const Eigen::Vector3d b = path_W[n + 1] - path_W[n];
    const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
    if (angle > 1e-9) least = std::min(least, 0.5 * (a.norm() + b.norm()) / angle);
  }
  return least;
}

TEST(FlyablePath, ARightAngleInTheOpenBecomesACurveThatIsHardlyLonger) {
  const PlanningMap map = OpenSpace();
  const Points corner_W = {{1.05, 1.05, 1.05}, {4.05, 1.05, 1.05}, {4.05, 4.05, 1.05}};
  const Points curve_W = MakeFlyable(map, corner_W, kKeep, false);
  EXPECT_EQ(curve_W.front(), corner_W.front());
  EXPECT_EQ(curve_W.back(), corner_W.back());
  EXPECT_GT(LeastRadius(curve_W), 0.3) << "0.95 m/s at 3 m/s^2";
  EXPECT_LT(PathLength(curve_W), PathLength(corner_W) * 1.02);
}

TEST(FlyablePath, ARobotThatMovesGoesOnAsItMovesBeforeItTurns) {
  const PlanningMap map = OpenSpace();
  const Points path_W = {{1.05, 3.05, 1.05}, {1.15, 3.05, 1.05}, {1.15, 5.05, 1.05}};
  const Points curve_W = MakeFlyable(map, path_W, kKeep, true);
  ASSERT_GE(curve_W.size(), 3U);
  EXPECT_EQ(curve_W.front(), path_W.front());
  const Eigen::Vector3d sets_out_W = (curve_W[1] - curve_W[0]).normalized();
  EXPECT_NEAR(sets_out_W.x(), 1.0, 1e-9);
  EXPECT_GT(LeastRadius(curve_W), 0.05) << "no corner is left, although the first segment stays";
}

TEST(FlyablePath, APathWithoutCornersStays) {
  const Points path_W = {{1.05, 1.05, 1.05}, {2.05, 1.05, 1.05}, {4.05, 1.05, 1.05}};
  EXPECT_EQ(MakeFlyable(OpenSpace(), path_W, kKeep, false), path_W);
}

class FlyablePathOnRandomMaps : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Seeds, FlyablePathOnRandomMaps, testing::Range(1U, 9U));

TEST_P(FlyablePathOnRandomMaps, KeepsEndsAndClearanceAndIsSeldomSharper) {
  std::mt19937 random(GetParam());
  PlanningMap map({.voxel_size = kSize, .clearance = kClearance, .bounds = {}});
  map.Apply(test::RandomScene(random, {{0, 0, 0}, {30, 30, 16}}, 8, 6));
  const std::vector<VoxelIndex> traversable = test::TraversableVoxels(map);
  ASSERT_GT(traversable.size(), 50U);
  int curves = 0;
  for (int n = 0; n < 30; ++n) {
    const Points path_W = test::RandomPath(random, map, traversable);
    if (path_W.empty()) continue;
    const Points curve_W = MakeFlyable(map, path_W, kKeep, false);
    EXPECT_EQ(curve_W.front(), path_W.front());
    EXPECT_EQ(curve_W.back(), path_W.back());
    const double before = test::SampledClearance(map, path_W, Obstacles::kOccupiedAndUnknown, kClearance);
    EXPECT_GE(test::SampledClearance(map, curve_W, Obstacles::kOccupiedAndUnknown, kClearance),
              before - 1e-3);
    EXPECT_LT(PathLength(curve_W), 1.2 * PathLength(path_W) + 0.2);
    curves += curve_W != path_W ? 1 : 0;
  }
  EXPECT_GT(curves, 0);
}

}  // namespace
}  // namespace thalweg::explorer
