#include "common/geometry/height_color.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

TEST(HeightColor, GoesFromBlueToOrangeWithoutJumps) {
  const Rgb low = HeightColor(0.0F);
  const Rgb high = HeightColor(1.0F);
  EXPECT_GT(low.b, low.r);
  EXPECT_GT(high.r, high.b);
  for (int k = 1; k <= 1000; ++k) {
    const Rgb before = HeightColor(0.001F * static_cast<float>(k - 1));
    const Rgb now = HeightColor(0.001F * static_cast<float>(k));
    EXPECT_LE(std::abs(before.r - now.r) + std::abs(before.g - now.g) + std::abs(before.b - now.b), 6) << k;
  }
}

TEST(HeightColor, IsLimitedToTheRamp) {
  EXPECT_EQ(HeightColor(-3.0F), HeightColor(0.0F));
  EXPECT_EQ(HeightColor(7.0F), HeightColor(1.0F));
}

}  // namespace
}  // namespace thalweg
