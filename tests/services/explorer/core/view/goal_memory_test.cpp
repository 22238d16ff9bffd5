#include "services/explorer/core/view/goal_memory.h"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "common/geometry/robot_model.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

class GoalMemoryTest : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Seeds, GoalMemoryTest, testing::Range(1, 9));

TEST_P(GoalMemoryTest, GivesTheSameGoalsAsAFreshSearchHoweverTheMapChanges) {
  std::mt19937 random(static_cast<unsigned>(GetParam()));
  const double camera_height = GetParam() % 2 == 0 ? 0.34 : 0.0;
  PlanningMap map({.voxel_size = 0.1, .clearance = 0.15, .bounds = {}, .camera_height = camera_height});
  const VoxelBox whole{{0, 0, 0}, {60, 60, 15}};
  map.Apply(test::RandomScene(random, whole, 60, 30));
  const ViewPlanner views(DepthSensorModel{}.camera, RobotModel{});
  const GoalFinder finder(test::kLookRange, 0.1);
  GoalMemory memory(finder);
  PathSearch search;
  std::size_t goals = 0;
  std::size_t asked = 0;
  std::size_t searched = 0;
  for (int round = 0; round < 12; ++round) {
    // The robot moves, and something changes, now and then far away or beyond what was in the map.
    const std::vector<VoxelIndex> traversable = test::TraversableVoxels(map);
    ASSERT_FALSE(traversable.empty());
    search.Flood(map, {{traversable[random() % traversable.size()], 0}});
    const std::vector<Cluster> clusters =
        FindFrontiers(map, DenseGrid<std::uint8_t>(map.box(), 0), {}).clusters;
    const auto remembered = memory.GoalsOf(clusters, map, search, views);
    ASSERT_EQ(remembered.size(), clusters.size());
    asked += clusters.size();
    searched += memory.searched();
    for (std::size_t n = 0; n < clusters.size(); ++n) {
      ASSERT_EQ(remembered[n], finder.GoalsOf(clusters[n], map, search, views)) << n << " in round " << round;
      goals += remembered[n].size();
    }
    if (round == 8) {  // another, smaller map
      map.Reset();
      map.Apply(test::RandomScene(random, {{10, 10, 0}, {40, 40, 15}}, 30, 20));
    }
    const VoxelIndex at{static_cast<int>(random() % 70), static_cast<int>(random() % 60),
                        static_cast<int>(random() % 15)};
    constexpr std::array kStates = {VoxelState::kFree, VoxelState::kOccupied};
    map.Apply(test::BoxOf(CubeAround(at, static_cast<int>(random() % 4)), kStates[random() % 2]));
  }
  EXPECT_GT(goals, 100U);
  EXPECT_LT(5 * searched, 4 * asked) << "it remembers some, though what is reached differs each time";
}

}  // namespace
}  // namespace thalweg::explorer
