#include "services/mapper/core/map_operations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <stdexcept>
#include <tuple>

namespace thalweg::mapper {
namespace {

using testing::UnorderedElementsAre;

ColoredMap Map(double voxel_size = 0.1) {
  return {.grid = OccupancyGrid(voxel_size), .colors = {}};
}

/// Random log-odds in a cube of 20 voxels around the origin; a third stays unknown.
ColoredMap RandomMap(unsigned seed) {
  ColoredMap map = Map();
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> log_odds(-2.0F, 3.5F);
  VoxelIndex i{};
  for (i.z = -10; i.z < 10; ++i.z) {
    for (i.y = -10; i.y < 10; ++i.y) {
      for (i.x = -10; i.x < 10; ++i.x) {
        if (random() % 3 != 0) map.grid.Set(i, log_odds(random));
      }
    }
  }
  return map;
}

TEST(MapOperations, SummaryCountsVoxelsAndTheirBounds) {
  ColoredMap map = Map();
  map.grid.Set({-2, 0, 5}, -1.0F);
  map.grid.Set({3, 1, 5}, 0.0F);
  map.grid.Set({3, 2, 5}, 2.0F);
  map.colors.Add({3, 2, 5}, {1, 2, 3});
  const MapSummary summary = Summarize(map);
  EXPECT_EQ(summary.free, 1U);
  EXPECT_EQ(summary.occupied, 2U);
  EXPECT_EQ(summary.colored, 1U);
  ASSERT_TRUE(summary.bounds_W);
  EXPECT_TRUE(summary.bounds_W->min().isApprox(Eigen::Vector3d(-0.2, 0.0, 0.5), 1e-12));
  EXPECT_TRUE(summary.bounds_W->max().isApprox(Eigen::Vector3d(0.4, 0.3, 0.6), 1e-12));
  EXPECT_FALSE(Summarize(Map()).bounds_W);
}

TEST(MapOperations, CropKeepsWhatHasItsCenterInTheBox) {
  const ColoredMap map = RandomMap(1);
  const Eigen::AlignedBox3d box_W(Eigen::Vector3d(-0.5, -0.21, 0.0), Eigen::Vector3d(0.33, 0.7, 0.95));
  const ColoredMap cropped = Crop(map, box_W);
  std::size_t kept = 0;
  map.grid.ForEachKnown([&](const VoxelIndex& voxel, float log_odds) {
    const bool inside = box_W.contains(map.grid.CenterOf(voxel));
    EXPECT_EQ(std::isnan(cropped.grid.LogOdds(voxel)), !inside);
    if (!inside) return;
    EXPECT_EQ(cropped.grid.LogOdds(voxel), log_odds);
    ++kept;
  });
  EXPECT_EQ(Summarize(cropped).known(), kept);
}

TEST(MapOperations, MergeAddsLogOddsWithinTheLimits) {
  ColoredMap merged = RandomMap(2);
  const ColoredMap before = RandomMap(2);
  const ColoredMap other = RandomMap(3);
  Merge(other, merged);
  VoxelIndex i{};
  for (i.z = -10; i.z < 10; ++i.z) {
    for (i.y = -10; i.y < 10; ++i.y) {
      for (i.x = -10; i.x < 10; ++i.x) {
        const float a = before.grid.LogOdds(i);
        const float b = other.grid.LogOdds(i);
        const float sum = merged.grid.LogOdds(i);
        if (std::isnan(a) && std::isnan(b)) {
          EXPECT_TRUE(std::isnan(sum));
        } else if (std::isnan(a) || std::isnan(b)) {
          EXPECT_EQ(sum, std::isnan(a) ? b : a);
        } else {
          EXPECT_EQ(sum, std::fmin(std::fmax(a + b, -2.0F), 3.5F));
        }
      }
    }
  }
}

TEST(MapOperations, MergeTakesTheColorOfWhereItIsOccupied) {
  ColoredMap into = Map();
  ColoredMap from = Map();
  into.grid.Set({0, 0, 0}, 1.0F);
  into.colors.Add({0, 0, 0}, {1, 1, 1});
  from.grid.Set({0, 0, 0}, 1.0F);
  from.colors.Add({0, 0, 0}, {9, 9, 9});
  from.grid.Set({1, 0, 0}, 1.0F);
  from.colors.Add({1, 0, 0}, {9, 9, 9});
  Merge(from, into);
  EXPECT_EQ(into.colors.At({0, 0, 0}), (Rgb{1, 1, 1}));
  EXPECT_EQ(into.colors.At({1, 0, 0}), (Rgb{9, 9, 9}));
}

TEST(MapOperations, MapsOfOtherVoxelsAreRefused) {
  ColoredMap into = Map(0.1);
  EXPECT_THROW(Merge(Map(0.2), into), std::invalid_argument);
  EXPECT_THROW(DifferenceOf(Map(0.1).grid, Map(0.05).grid), std::invalid_argument);
  EXPECT_NO_THROW(Merge(Map(0.1 + 1e-9), into));
}

class Coarsening : public testing::TestWithParam<int> {};

TEST_P(Coarsening, IsTheLargestOfTheVoxelsWithin) {
  const ColoredMap map = RandomMap(4);
  const int factor = GetParam();
  const ColoredMap coarse = Coarsen(map, factor);
  EXPECT_DOUBLE_EQ(coarse.grid.voxel_size(), 0.1 * factor);
  std::map<std::tuple<int, int, int>, float> largest;
  map.grid.ForEachKnown([&](const VoxelIndex& voxel, float log_odds) {
    const VoxelIndex at = coarse.grid.IndexOf(map.grid.CenterOf(voxel));
    const auto [place, is_new] = largest.try_emplace({at.x, at.y, at.z}, log_odds);
    if (!is_new) place->second = std::fmax(place->second, log_odds);
  });
  for (const auto& [at, log_odds] : largest) {
    EXPECT_EQ(coarse.grid.LogOdds({std::get<0>(at), std::get<1>(at), std::get<2>(at)}), log_odds);
  }
  EXPECT_EQ(Summarize(coarse).known(), largest.size());
}
INSTANTIATE_TEST_SUITE_P(Factors, Coarsening, testing::Values(2, 3, 7));

TEST(MapOperations, CoarseningByOtherFactorsIsRefused) {
  for (const int factor : {-1, 0, 1, 1025}) EXPECT_THROW(Coarsen(Map(), factor), std::invalid_argument);
}

TEST(MapOperations, CoarseningFactorIsTheVoxelsAlongAnEdge) {
  for (const double voxel_size : {0.01, 0.05, 0.1, 0.3}) {
    for (const int factor : {1, 2, 7, 1000}) {
      EXPECT_EQ(CoarseningFactor(voxel_size, factor * voxel_size), factor) << voxel_size;
      EXPECT_EQ(CoarseningFactor(voxel_size, (factor + 0.01) * voxel_size), std::nullopt) << voxel_size;
    }
    EXPECT_EQ(CoarseningFactor(voxel_size, voxel_size / 2.0), std::nullopt) << voxel_size;
    EXPECT_EQ(CoarseningFactor(voxel_size, voxel_size * 1e-6), std::nullopt) << voxel_size;
    EXPECT_EQ(CoarseningFactor(voxel_size, 1e9), std::nullopt) << voxel_size;
  }
}

TEST(MapOperations, DifferenceCountsEachVoxelOnce) {
  ColoredMap first = Map();
  ColoredMap second = Map();
  const auto set = [](ColoredMap& map, std::int32_t x, float log_odds) { map.grid.Set({x, 0, 0}, log_odds); };
  set(first, 0, -1.0F), set(second, 0, -2.0F);  // free in both
  set(first, 1, 1.0F), set(second, 1, 2.0F);    // occupied in both
  set(first, 2, -1.0F), set(second, 2, 1.0F);   // appeared
  set(first, 3, 1.0F), set(second, 3, -1.0F);   // vanished
  set(first, 4, 1.0F);
  set(second, 5, -1.0F);
  const MapDifference difference = DifferenceOf(first.grid, second.grid);
  EXPECT_EQ(difference.counts[1][1], 1U);
  EXPECT_EQ(difference.counts[2][2], 1U);
  EXPECT_EQ(difference.counts[1][2], 1U);
  EXPECT_EQ(difference.counts[2][1], 1U);
  EXPECT_EQ(difference.counts[2][0], 1U);
  EXPECT_EQ(difference.counts[0][1], 1U);
  EXPECT_THAT(difference.appeared, UnorderedElementsAre(VoxelIndex{2, 0, 0}));
  EXPECT_THAT(difference.vanished, UnorderedElementsAre(VoxelIndex{3, 0, 0}));
  EXPECT_EQ(difference.known_to_both(), 4U);
  EXPECT_EQ(difference.differing(), 4U) << "two changed, and two are known to one map alone";
  EXPECT_EQ(DifferenceOf(first.grid, first.grid).differing(), 0U);
  EXPECT_DOUBLE_EQ(difference.agreement().value(), 0.5);
  EXPECT_EQ(DifferenceOf(Map().grid, first.grid).agreement(), std::nullopt);
}

TEST(MapOperations, PaintedDifferenceShowsWhatAppearedInGreenAndWhatVanishedInRed) {
  MapDifference difference;
  difference.appeared = {{2, 0, 0}, {-9, 4, 1}};
  difference.vanished = {{3, 0, 0}};
  const ColoredMap painted = PaintedDifference(difference, 0.25);
  EXPECT_EQ(painted.grid.voxel_size(), 0.25);
  const MapSummary summary = Summarize(painted);
  EXPECT_EQ(summary.occupied, 3U);
  EXPECT_EQ(summary.known(), 3U);
  for (const VoxelIndex& voxel : difference.appeared) {
    const Rgb color = painted.colors.At(voxel).value();
    EXPECT_GT(color.g, 2 * std::max(color.r, color.b));
  }
  const Rgb color = painted.colors.At({3, 0, 0}).value();
  EXPECT_GT(color.r, 2 * std::max(color.g, color.b));
}

}  // namespace
}  // namespace thalweg::mapper
