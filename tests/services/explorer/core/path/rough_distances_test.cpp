#include "services/explorer/core/path/rough_distances.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/services/explorer/support/random_planning_map.h"
#include "tests/services/explorer/support/reached_places.h"

namespace thalweg::explorer {
namespace {

class RoughDistancesTest : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Seeds, RoughDistancesTest, testing::Range(1U, 9U));

TEST_P(RoughDistancesTest, AreExactNearbyAndNeverTooShortFartherAway) {
  std::mt19937 random(GetParam());
  PlanningMap map({.voxel_size = 0.1, .clearance = 0.15, .bounds = {}});
  map.Apply(test::RandomScene(random, {{0, 0, 0}, {100, 60, 22}}, 60, 10));
  PathSearch search;
  const std::vector<VoxelIndex> places = test::ReachedPlaces(map, 200, random, search);
  CoarseMap coarse(map, search);
  RoughDistances rough(coarse, places);
  std::size_t far = 0;
  double exact_sum = 0.0;
  double rough_sum = 0.0;
  for (std::size_t a = 0; a < places.size(); a += 10) {
    const std::vector<double> exact = coarse.DistancesFrom(places[a], places);
    const std::vector<double> lengths = rough.From(a);
    ASSERT_EQ(lengths.size(), places.size());
    for (std::size_t b = 0; b < places.size(); ++b) {
      // What leads around a corner may be shorter than both parts of a path by way of a landmark, which end
      // in the middles of cells.
      EXPECT_GE(lengths[b], exact[b] - 0.3) << b;
      EXPECT_TRUE(exact[b] >= 0.7 * RoughDistances::kNear || lengths[b] == exact[b]) << b;
      if (exact[b] < 1.3 * RoughDistances::kNear) continue;
      ++far;
      exact_sum += exact[b];
      rough_sum += lengths[b];
    }
  }
  ASSERT_GT(far, 1000U);
  EXPECT_LT(rough_sum, 1.25 * exact_sum);
}

TEST(RoughDistances, AreExactWhereEveryPlaceIsALandmark) {
  PlanningMap map({.voxel_size = 0.1, .clearance = 0.15, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {120, 12, 12}}, VoxelState::kFree));
  PathSearch search;
  const std::vector<VoxelIndex> places = {{5, 5, 6}, {40, 6, 6}, {75, 5, 5}, {110, 6, 5}};
  search.Flood(map, {{places.front(), 0}});
  CoarseMap coarse(map, search);
  RoughDistances rough(coarse, places);
  for (std::size_t n = 0; n < places.size(); ++n) {
    const std::vector<double> exact = coarse.DistancesFrom(places[n], places);
    const std::vector<double> lengths = rough.From(n);
    for (std::size_t m = 0; m < places.size(); ++m) EXPECT_NEAR(lengths[m], exact[m], 1e-9);
  }
}

}  // namespace
}  // namespace thalweg::explorer
