#include "services/mapper/core/voxel_colors.h"

#include <gtest/gtest.h>

#include <random>

namespace thalweg::mapper {
namespace {

TEST(VoxelColors, IsTheMeanOfTheColorsGiven) {
  VoxelColors colors;
  std::mt19937 random(4);
  std::uniform_int_distribution<int> value(0, 255);
  const VoxelIndex voxel{-3, 70, 5};
  EXPECT_EQ(colors.At(voxel), std::nullopt);
  double sum[3] = {0, 0, 0};
  for (int n = 1; n <= VoxelColors::kMaxCount; ++n) {
    const Rgb color{static_cast<std::uint8_t>(value(random)), static_cast<std::uint8_t>(value(random)), 255};
    colors.Add(voxel, color);
    sum[0] += color.r;
    sum[1] += color.g;
    sum[2] += color.b;
    EXPECT_NEAR(colors.At(voxel)->r, sum[0] / n, 1.0);
    EXPECT_NEAR(colors.At(voxel)->g, sum[1] / n, 1.0);
    EXPECT_EQ(colors.At(voxel)->b, 255);
  }
  EXPECT_EQ(colors.At({-3, 70, 6}), std::nullopt);
}

TEST(VoxelColors, ReportsWhetherTheRoundedColorChanged) {
  VoxelColors colors;
  const VoxelIndex voxel{0, 0, 0};
  EXPECT_TRUE(colors.Add(voxel, {10, 20, 30}).changed) << "there was none";
  EXPECT_FALSE(colors.Add(voxel, {10, 20, 30}).changed);
  EXPECT_TRUE(colors.Add(voxel, {10, 20, 60}).changed);
  const std::optional<Rgb> before = colors.At(voxel);
  for (int n = 0; n < 80; ++n) colors.Add(voxel, *before);
  EXPECT_EQ(colors.At(voxel), before);
  Rgb hardly = *before;
  ++hardly.g;
  EXPECT_FALSE(colors.Add(voxel, hardly).changed) << "an eightieth of a step";
  EXPECT_EQ(colors.At(voxel), before);
}

TEST(VoxelColors, CopiesAreIndependent) {
  VoxelColors colors;
  colors.Add({1, 2, 3}, {10, 20, 30});
  const VoxelColors copy = colors;
  colors.Add({1, 2, 3}, {200, 200, 200});
  EXPECT_EQ(copy.At({1, 2, 3}), (Rgb{10, 20, 30}));
}

}  // namespace
}  // namespace thalweg::mapper
