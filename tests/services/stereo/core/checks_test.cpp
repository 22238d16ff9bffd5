#include "services/stereo/core/checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace thalweg::stereo {
namespace {

/// The same by flood fill from each pixel.
DisparityMap SlowlyRemoved(const DisparityMap& disparity, int min_pixels, float max_step) {
  DisparityMap out = disparity;
  for (int v = 0; v < disparity.height(); ++v) {
    for (int u = 0; u < disparity.width(); ++u) {
      std::vector<std::pair<int, int>> region = {{u, v}};
      Image<int> seen(disparity.width(), disparity.height());
      seen(u, v) = 1;
      for (std::size_t i = 0; i < region.size(); ++i) {
        const auto [x, y] = region[i];
        for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
          const int a = x + dx;
          const int b = y + dy;
          if (a < 0 || b < 0 || a >= disparity.width() || b >= disparity.height() || seen(a, b) != 0)
            continue;
          if (!(std::abs(disparity(a, b) - disparity(x, y)) <= max_step)) continue;
          seen(a, b) = 1;
          region.emplace_back(a, b);
        }
      }
      if (static_cast<int>(region.size()) < min_pixels) out(u, v) = kNoDisparity;
    }
  }
  return out;
}

TEST(RemoveSmallRegions, EqualsFloodingOnRandomMaps) {
  std::mt19937 random(1);
  for (int round = 0; round < 20; ++round) {
    DisparityMap disparity(31, 22);
    std::uniform_int_distribution<int> value(0, 3);
    for (float& d : disparity.data()) {
      const int k = value(random);
      d = k == 3 ? kNoDisparity : static_cast<float>(k) * 1.1F;
    }
    const DisparityMap expected = SlowlyRemoved(disparity, 5, 1.2F);
    RemoveSmallRegions(disparity, 5, 1.2F);
    EXPECT_THAT(disparity.data(), testing::Pointwise(testing::NanSensitiveFloatEq(), expected.data()));
  }
}

TEST(ParabolaVertex, IsThatOfTheParabola) {
  for (const float x : {-0.5F, -0.2F, 0.0F, 0.45F}) {
    const auto parabola = [&](float at) { return 3.0F * (at - x) * (at - x) + 1.0F; };
    EXPECT_NEAR(ParabolaVertex(parabola(-1), parabola(0), parabola(1)), x, 1e-5);
  }
  EXPECT_EQ(ParabolaVertex(4, 4, 4), 0.0F);
}

}  // namespace
}  // namespace thalweg::stereo
