#include "common/voxel/occupancy_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <stdexcept>
#include <tuple>

namespace thalweg {
namespace {

VoxelIndex RandomVoxel(std::mt19937& random) {
  std::uniform_int_distribution<std::int32_t> coordinate(-20, 20);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

TEST(OccupancyGrid, RefusesAVoxelSizeThatIsNone) {
  EXPECT_THROW(OccupancyGrid(0.0), std::invalid_argument);
  EXPECT_THROW(OccupancyGrid(-0.1), std::invalid_argument);
  EXPECT_THROW(OccupancyGrid(std::nan("")), std::invalid_argument);
  EXPECT_THROW(OccupancyGrid{std::numeric_limits<double>::infinity()}, std::invalid_argument);
}

TEST(OccupancyGrid, HoldsWhatAPlainMapHolds) {
  std::mt19937 random(6);
  OccupancyGrid grid(0.1);
  std::map<std::tuple<int, int, int>, float> expected;
  for (int k = 0; k < 5000; ++k) {
    const VoxelIndex i = RandomVoxel(random);
    const float value = std::uniform_real_distribution<float>(-2.0F, 3.5F)(random);
    grid.Set(i, value);
    expected[{i.x, i.y, i.z}] = value;
  }
  std::size_t known = 0;
  grid.ForEachKnown([&](const VoxelIndex& i, float value) {
    ++known;
    EXPECT_EQ(expected.at({i.x, i.y, i.z}), value);
  });
  EXPECT_EQ(known, expected.size());
  for (const auto& [key, value] : expected) {
    EXPECT_EQ(grid.LogOdds({std::get<0>(key), std::get<1>(key), std::get<2>(key)}), value);
  }
  EXPECT_EQ(grid.State({100, 100, 100}), VoxelState::kUnknown);
}

TEST(OccupancyGrid, BlocksAndOffsetsNameEachVoxelOnce) {
  for (std::int32_t v = -17; v <= 17; ++v) {
    const VoxelIndex i{v, -v, 2 * v};
    const VoxelIndex block = OccupancyGrid::BlockOf(i);
    EXPECT_EQ(block.x, static_cast<std::int32_t>(std::floor(i.x / 8.0)));
    EXPECT_EQ(block.y, static_cast<std::int32_t>(std::floor(i.y / 8.0)));
    EXPECT_EQ(OccupancyGrid::IndexInBlock(block, OccupancyGrid::OffsetInBlock(i)), i);
  }
}

TEST(OccupancyGrid, StateIsOccupiedFromProbabilityOneHalfOn) {
  EXPECT_EQ(OccupancyGrid::StateOf(0.0F), VoxelState::kOccupied);
  EXPECT_EQ(OccupancyGrid::StateOf(-1e-6F), VoxelState::kFree);
  EXPECT_EQ(OccupancyGrid::StateOf(OccupancyGrid::kUnknown), VoxelState::kUnknown);
}

TEST(OccupancyGrid, IsTheSameOnlyWithTheSameKnownVoxels) {
  OccupancyGrid a(0.1);
  OccupancyGrid b(0.1);
  a.Set({1, 2, 3}, 0.5F);
  EXPECT_FALSE(a.SameAs(b));
  EXPECT_FALSE(b.SameAs(a));
  b.Set({1, 2, 3}, 0.5F);
  b.Set({50, 0, 0}, OccupancyGrid::kUnknown);
  EXPECT_TRUE(a.SameAs(b));
  b.Set({50, 0, 0}, -0.4F);
  EXPECT_FALSE(a.SameAs(b));
  EXPECT_FALSE(OccupancyGrid(0.1).SameAs(OccupancyGrid(0.2)));
}

TEST(OccupancyGrid, VoxelSpansItsIndexTimesItsSize) {
  const OccupancyGrid grid(0.25);
  EXPECT_EQ(grid.IndexOf({0.25, -0.01, -0.25}), (VoxelIndex{1, -1, -1}));
  EXPECT_TRUE(grid.CenterOf({1, -1, 0}).isApprox(Eigen::Vector3d(0.375, -0.125, 0.125)));
}

}  // namespace
}  // namespace thalweg
