#include "services/cli/report/coverage_tally.h"

#include <gtest/gtest.h>

namespace thalweg::cli {
namespace {

ProgressSample At(double time, double distance) {
  ProgressSample sample;
  sample.time = time;
  sample.distance = distance;
  return sample;
}

TEST(CoverageTally, CountsEachVoxelOnceAndDecidesLaterWhichOnesMatter) {
  CoverageTally tally;
  for (int x = 0; x < 4; ++x) tally.Add(VoxelIndex{x, -1, 9});
  tally.Add(VoxelIndex{0, -1, 9});
  tally.Sample(At(1.0, 0.5), 0.001);
  for (int x = 0; x < 10; ++x) tally.Add(VoxelIndex{x, -1, 9});
  tally.Sample(At(2.0, 1.0), 0.001);
  const auto samples = tally.SamplesWith([](const VoxelIndex& i) { return i.x % 2 == 0; }, 8);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_DOUBLE_EQ(samples[0].explored, 0.004);
  EXPECT_DOUBLE_EQ(samples[1].explored, 0.010);
  EXPECT_DOUBLE_EQ(*samples[0].coverage, 2.0 / 8.0);
  EXPECT_DOUBLE_EQ(*samples[1].coverage, 5.0 / 8.0);
  EXPECT_FALSE(tally.samples()[0].coverage);
}

TEST(CoverageTally, HoldsNoMoreThanItsLimitsAndSaysSo) {
  CoverageTally voxels(/*most_voxels=*/10);
  for (int x = 0; x < 10; ++x) voxels.Add(VoxelIndex{x, 0, 0});
  EXPECT_FALSE(voxels.full());
  voxels.Add(VoxelIndex{3, 0, 0});  // counted already
  EXPECT_FALSE(voxels.full());
  voxels.Add(VoxelIndex{10, 0, 0});
  EXPECT_TRUE(voxels.full());
  EXPECT_EQ(voxels.known(), 10U);
  CoverageTally blocks(CoverageTally::kMostVoxels, /*most_blocks=*/5);
  for (int x = 0; x < 100; ++x) blocks.Add(VoxelIndex{100 * x, 0, 0});
  EXPECT_TRUE(blocks.full());
  EXPECT_EQ(blocks.known(), 5U);
}

}  // namespace
}  // namespace thalweg::cli
