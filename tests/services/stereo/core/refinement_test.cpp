#include "services/stereo/core/refinement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/random_images.h"

namespace thalweg::stereo {
namespace {

/// A slanted plane, and the output of a matcher that is biased toward whole pixels.
class Refined : public testing::Test {
 protected:
  static constexpr int kWidth = 160;
  static constexpr int kHeight = 90;
  /// Where windows reach outside the image, and disparities outside the other one.
  static constexpr int kMargin = 30;

  static double Truth(int u, int v) { return 0.04 * u - 0.02 * v + 6.0; }
  static DisparityMap DrawnToWholePixels() {
    DisparityMap disparity(kWidth, kHeight);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const double d = Truth(u, v);
        disparity(u, v) = static_cast<float>(std::lround(d) + 0.4 * (d - std::lround(d)));
      }
    }
    return disparity;
  }
  static double WorstError(const DisparityMap& disparity) {
    double worst = 0.0;
    for (int v = kMargin; v < kHeight - kMargin; ++v) {
      for (int u = kMargin; u < kWidth - kMargin; ++u) {
        worst = std::max(worst, std::abs(disparity(u, v) - Truth(u, v)));  // NaN does not count as an error
      }
    }
    return worst;
  }
  const test::Pair pair_ = test::PlanePair(kWidth, kHeight, 0.04, -0.02, 6.0, 31);
};

TEST_F(Refined, DisparitiesDrawnToWholePixelsBecomeTrue) {
  DisparityMap disparity = DrawnToWholePixels();
  ASSERT_GT(WorstError(disparity), 0.25);
  Refine(pair_.left, pair_.right, {}, 1, disparity);
  EXPECT_LT(WorstError(disparity), 0.08);
  EXPECT_FALSE(std::isnan(disparity(kWidth / 2, kHeight / 2)));
}

TEST_F(Refined, ABrighterRightImageMovesNothing) {
  ByteImage brighter = pair_.right;
  for (std::uint8_t& value : brighter.data()) value = static_cast<std::uint8_t>(value + 9);
  DisparityMap disparity = DrawnToWholePixels();
  Refine(pair_.left, brighter, {}, 1, disparity);
  EXPECT_LT(WorstError(disparity), 0.08);
}

TEST_F(Refined, ThreadsChangeNoBit) {
  DisparityMap one = DrawnToWholePixels();
  DisparityMap two = one;
  Refine(pair_.left, pair_.right, {}, 1, one);
  Refine(pair_.left, pair_.right, {}, 2, two);
  EXPECT_THAT(two.data(), testing::Pointwise(testing::NanSensitiveFloatEq(), one.data()));
}

TEST_F(Refined, WithoutTextureNothingMovesButTheNoiseGoes) {
  const ByteImage blank(kWidth, kHeight, 1, 90);
  DisparityMap disparity(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) disparity(u, v) = (u + v) % 2 == 0 ? 9.7F : 10.3F;
  }
  Refine(blank, blank, {}, 1, disparity);
  for (const float d : disparity.data()) ASSERT_NEAR(d, 10.0F, 0.06F);
}

TEST_F(Refined, DropsWhatIsBesideAJumpOrAGapAndNoMore) {
  const ByteImage blank(40, 9, 1, 90);
  DisparityMap disparity(40, 9, 1, 5.0F);
  for (int v = 0; v < 9; ++v) {
    for (int u = 20; u < 40; ++u) disparity(u, v) = 12.0F;
  }
  disparity(30, 4) = kNoDisparity;
  RefinementOptions options;
  options.least_region = 0;
  for (const int margin : {0, 1, 2}) {
    options.margin = margin;
    DisparityMap refined = disparity;
    Refine(blank, blank, options, 1, refined);
    for (int v = 0; v < 9; ++v) {
      for (int u = 0; u < 40; ++u) {
        const bool at_jump = u >= 20 - margin && u < 20 + margin;
        const bool at_gap = std::max(std::abs(u - 30), std::abs(v - 4)) <= margin;
        EXPECT_EQ(std::isnan(refined(u, v)), at_jump || at_gap) << u << ' ' << v << " margin " << margin;
        if (at_jump || at_gap) continue;
        EXPECT_FLOAT_EQ(refined(u, v), u < 20 ? 5.0F : 12.0F) << "never mixed";
      }
    }
  }
}

/// A slanted wall with islands of something far behind it; what counts is the size left after dropping the
/// edges.
TEST_F(Refined, DropsIslandsThatAreTooSmallAndNoMore) {
  const ByteImage blank(kWidth, kHeight, 1, 90);
  DisparityMap disparity(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) disparity(u, v) = 40.0F + 0.2F * static_cast<float>(u);
  }
  const auto put_island = [&](int u0, int v0, int side) {
    for (int v = v0; v < v0 + side; ++v) std::fill_n(disparity.Row(v) + u0, side, 5.0F);
  };
  put_island(10, 20, 11);  // 9 x 9 pixels of it are away from its edges
  put_island(60, 20, 12);  // 10 x 10
  RefinementOptions options;
  options.least_region = 100;
  Refine(blank, blank, options, 1, disparity);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < 40; ++u) EXPECT_FALSE(disparity(u, v) < 39.0F) << u << ' ' << v;
  }
  EXPECT_FLOAT_EQ(disparity(65, 25), 5.0F);
  EXPECT_NEAR(disparity(120, 45), 64.0F, 0.01F);
}

TEST_F(Refined, TakesImagesSmallerThanItsWindows) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{2, 9}, std::pair{9, 2}}) {
    DisparityMap disparity(width, height, 1, 0.0F);
    const ByteImage image = test::RandomImage(width, height, 5);
    Refine(image, image, {.least_region = 0}, 1, disparity);
    EXPECT_THAT(disparity.data(), testing::Each(testing::Ge(0.0F)));
  }
}

TEST_F(Refined, NamesABadOption) {
  EXPECT_THAT([] { CheckOptions({.margin = -1}); },
              testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("margin is -1")));
  EXPECT_THAT([] { CheckOptions({.least_region = -1}); },
              testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("least_region is -1")));
  EXPECT_THAT([] { CheckOptions({.radius = 0}); },
              testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("radius is 0")));
}

}  // namespace
}  // namespace thalweg::stereo
