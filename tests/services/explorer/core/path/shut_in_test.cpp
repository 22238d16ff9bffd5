#include "services/explorer/core/path/shut_in.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

using test::kSize;

constexpr double kRadius = 0.12;
constexpr double kMargin = 0.10;
const PathSearch::Exemption kExemption{0.3, true};

using Changes = std::vector<VoxelChange>;

/// A cell of 1 m and a hall of 2 m behind a wall that has a hole of `edge` x `edge` voxels through it.
Changes CellAndHall(int edge) {
  Changes changes;
  test::Fill(changes, {{-1, -1, -1}, {33, 21, 11}}, VoxelState::kOccupied);
  test::Fill(changes, {{0, 0, 0}, {10, 10, 10}}, VoxelState::kFree);
  test::Fill(changes, {{12, 0, 0}, {32, 20, 10}}, VoxelState::kFree);
  test::Fill(changes, {{10, 3, 3}, {12, 3 + edge, 3 + edge}}, VoxelState::kFree);
  return changes;
}

PlanningMap MapOf(const Changes& changes, double clearance, double half_height = 0.0) {
  PlanningMap::Options options;
  options.voxel_size = kSize;
  options.clearance = clearance;
  options.half_height = half_height;
  PlanningMap map(options);
  map.Apply(changes);
  return map;
}

TEST(ShutIn, NamesTheClearanceWithWhichTheDoorwayCouldBePassed) {
  // A body centered in a hole of 3 voxels keeps 0.15 m from its sides; in one of 1 voxel, 0.05 m.
  for (const auto& [edge, passes] : {std::pair{1, 0.05}, std::pair{3, 0.15}}) {
    const PlanningMap map = MapOf(CellAndHall(edge), kRadius + kMargin);
    const ShutIn why = WhyShutIn(map, {0.55, 0.55, 0.55}, kRadius, kExemption);
    EXPECT_DOUBLE_EQ(why.needed, 0.22);
    EXPECT_DOUBLE_EQ(why.here, why.needed) << "it stands in the open";
    ASSERT_TRUE(why.fitting) << edge;
    EXPECT_NEAR(*why.fitting, passes, 1e-9) << edge;
  }
}

TEST(ShutIn, FindsNoClearanceThatLeavesAClosedCell) {
  Changes changes = CellAndHall(1);
  test::Fill(changes, {{10, 3, 3}, {12, 4, 4}}, VoxelState::kOccupied);
  const ShutIn why = WhyShutIn(MapOf(changes, kRadius + kMargin), {0.55, 0.55, 0.55}, kRadius, kExemption);
  EXPECT_FALSE(why.fitting);
}

TEST(ShutIn, NamesTheSideOfTheNearestObstacle) {
  const PlanningMap map = MapOf(CellAndHall(1), kRadius + kMargin);
  const ShutIn low = WhyShutIn(map, {0.55, 0.55, 0.08}, kRadius, kExemption);
  EXPECT_EQ(low.side, ShutIn::Side::kBelow);
  EXPECT_NEAR(low.here, 0.08, 1e-9);
  const ShutIn high = WhyShutIn(map, {0.55, 0.55, 0.83}, kRadius, kExemption);
  EXPECT_EQ(high.side, ShutIn::Side::kAbove);
  EXPECT_NEAR(high.here, 0.17, 1e-9);
  const ShutIn aside = WhyShutIn(map, {0.55, 0.06, 0.5}, kRadius, kExemption);
  EXPECT_EQ(aside.side, ShutIn::Side::kBeside);
  EXPECT_NEAR(aside.here, 0.06, 1e-9);
}

TEST(ShutIn, MeasuresAnUprightCylinderByWhatReachesIntoIt) {
  // The body reaches from 0.1 m below the floor to 0.5 m: the floor is 0.1 m too high for it.
  const ShutIn why =
      WhyShutIn(MapOf(CellAndHall(3), kRadius + kMargin, 0.3), {0.55, 0.55, 0.2}, kRadius, kExemption);
  EXPECT_EQ(why.side, ShutIn::Side::kBelow);
  EXPECT_NEAR(why.here, why.needed - 0.1, 1e-9);
}

TEST(ShutIn, MeasuresTheClearanceThatThePlanningMapMeasures) {
  std::mt19937 random(7);
  int limited = 0;
  for (int round = 0; round < 200; ++round) {
    Changes changes;
    test::Fill(changes, {{0, 0, 0}, {16, 16, 16}}, VoxelState::kFree);
    for (int n = 0; n < 60; ++n)
      changes.push_back({test::RandomVoxel(random, {{1, 1, 1}, {15, 15, 15}}), test::kOccupiedLogOdds});
    const PlanningMap map = MapOf(changes, 0.25, round % 2 == 0 ? 0.0 : 0.2);
    const Eigen::Vector3d p_W =
        test::RandomPoint(random, {Eigen::Vector3d::Constant(0.4), Eigen::Vector3d::Constant(1.2)});
    const ShutIn why = WhyShutIn(map, p_W, kRadius, kExemption);
    EXPECT_NEAR(why.here, map.ClearanceAt(p_W, PlanningMap::Obstacles::kOccupied, 0.25), 1e-9) << round;
    limited += why.here < 0.25 ? 1 : 0;
  }
  EXPECT_GT(limited, 50);
}

}  // namespace
}  // namespace thalweg::explorer
