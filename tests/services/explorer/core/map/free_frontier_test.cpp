#include "services/explorer/core/map/free_frontier.h"

#include <gtest/gtest.h>

#include <unordered_map>

#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

TEST(FreeFrontier, EqualsBruteForceOnRandomMaps) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    const bool bounded = seed % 2 == 0;
    PlanningMap::Options options{.voxel_size = 0.1, .clearance = 0.15, .bounds = {}};
    if (bounded)
      options.bounds = Eigen::AlignedBox3d(Eigen::Vector3d(0.3, 0.0, 0.0), Eigen::Vector3d(2.0, 2.5, 1.0));
    PlanningMap map(options);
    const std::vector<VoxelChange> scene = test::RandomScene(random, {{0, 0, 0}, {24, 22, 14}}, 20, 7);
    map.Apply(scene);
    DenseGrid<std::uint8_t> aside(map.box(), 0);
    for (int n = 0; n < 200; ++n) aside[test::RandomVoxel(random, map.box())] = 1;

    const auto inside = [&](const VoxelIndex& i) { return map.InBounds(i); };
    std::unordered_map<VoxelIndex, float, VoxelIndexHash> known;
    for (const VoxelChange& change : scene) {
      known[change.voxel] = change.log_odds;
    }
    std::size_t expected = 0;
    const std::vector<VoxelIndex> found = FreeFrontier(map, aside);
    for (const auto& [voxel, log_odds] : known) {
      if (log_odds != test::kFreeLogOdds || !inside(voxel)) continue;
      bool open = false;
      for (int axis = 0; axis < 3; ++axis) {
        for (const int step : {-1, 1}) {
          VoxelIndex beside = voxel;
          (axis == 0 ? beside.x : axis == 1 ? beside.y : beside.z) += step;
          open |= known.count(beside) == 0 && inside(beside) && aside.Get(beside, 0) == 0;
        }
      }
      expected += open ? 1 : 0;
      EXPECT_EQ(std::ranges::count(found, voxel), open ? 1 : 0) << seed;
    }
    EXPECT_EQ(found.size(), expected) << seed;
    EXPECT_GT(expected, 100U);
  }
}

}  // namespace
}  // namespace thalweg::explorer
