#include "common/voxel/dense_grid.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

TEST(DenseGrid, OffsetsAndIndicesAreInverseAndXIsFastest) {
  const VoxelBox box{.min = {-2, 3, -1}, .max = {3, 7, 2}};
  const DenseGrid<int> grid(box, 0);
  ASSERT_EQ(grid.size(), 5U * 4U * 3U);
  std::size_t offset = 0;
  for (std::int32_t z = -1; z < 2; ++z) {
    for (std::int32_t y = 3; y < 7; ++y) {
      for (std::int32_t x = -2; x < 3; ++x, ++offset) {
        EXPECT_EQ(grid.Offset({x, y, z}), offset);
        EXPECT_EQ(grid.IndexAt(offset), (VoxelIndex{x, y, z}));
      }
    }
  }
  EXPECT_EQ(grid.Offset({0, 4, 0}) + static_cast<std::size_t>(grid.stride_y()), grid.Offset({0, 5, 0}));
  EXPECT_EQ(grid.Offset({0, 4, 0}) + static_cast<std::size_t>(grid.stride_z()), grid.Offset({0, 4, 1}));
}

TEST(DenseGrid, GivesTheOutsideValueBeyondItsBox) {
  DenseGrid<int> grid({.min = {0, 0, 0}, .max = {2, 2, 2}}, 5);
  grid[VoxelIndex{1, 1, 1}] = 7;
  EXPECT_EQ(grid.Get({1, 1, 1}, -1), 7);
  EXPECT_EQ(grid.Get({0, 0, 0}, -1), 5);
  EXPECT_EQ(grid.Get({2, 1, 1}, -1), -1);
  EXPECT_EQ(grid.Get({0, -1, 1}, -1), -1);
}

TEST(VoxelBox, WithoutExtentHoldsNothing) {
  const VoxelBox inverted{.min = {3, 0, 0}, .max = {1, 5, 5}};
  EXPECT_EQ(inverted.count(), 0U);
  EXPECT_FALSE(inverted.Contains({2, 1, 1}));
}

TEST(VoxelIndex, RangeIsSixteenBitsAnAxis) {
  EXPECT_TRUE(InIndexRange({-32768, 0, 32767}));
  EXPECT_FALSE(InIndexRange({0, 0, 32768}));
  EXPECT_FALSE(InIndexRange({0, -32769, 0}));
}

}  // namespace
}  // namespace thalweg
