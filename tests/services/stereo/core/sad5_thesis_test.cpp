#include "services/stereo/core/sad5_thesis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "services/stereo/core/sad5.h"
#include "tests/services/stereo/support/slow_reference.h"
#include "tests/support/random_images.h"

namespace thalweg::stereo {
namespace {

constexpr int kAnyDifference = 255;
constexpr int kSmallWindow = 7;  // [px] of a window; up to 9 px, no difference is truncated
constexpr int kDisparities = 16;

/// A textured plane of which a third of the left pixels are anything.
test::Pair Noisy(int width, int height) {
  test::Pair pair = test::PlanePair(width, height, 0.04, 0.0, 3.0, 3);
  const ByteImage noise = test::RandomImage(width, height, 4);
  for (std::size_t i = 0; i < pair.left.data().size(); i += 3) pair.left.data()[i] = noise.data()[i];
  return pair;
}

MatcherOptions WithWindow(int window) {
  MatcherOptions options;
  options.max_disparity = kDisparities;
  options.sad5.window = window;
  return options;
}

/// The engine from the definitions of its parts, with another tolerance of its left/right check.
DisparityMap SlowlyAsPrinted(const test::Pair& pair, const MatcherOptions& options, int left_right) {
  PrefilterOptions blur;
  blur.kind = Prefilter::kBilateralBlur;
  const ByteImage left = Filter(pair.left, blur);
  const ByteImage right = Filter(pair.right, blur);
  DisparityMap out(left.width(), left.height());
  for (int v = 0; v < left.height(); ++v) {
    std::vector<test::Costs> costs;
    for (int u = 0; u < left.width(); ++u) {
      costs.emplace_back();
      for (int d = 0; d < kDisparities; ++d) {
        costs.back().push_back(test::SlowSad5(left, right, u, v, d, options.sad5.window, kAnyDifference));
      }
    }
    const auto row = test::SlowChoose(costs, options.sad5.uniqueness, left_right, true);
    std::copy(row.begin(), row.end(), out.Row(v));
  }
  return test::SlowlyRemoved(out, options.sad5.speckle_pixels, static_cast<float>(options.sad5.speckle_step),
                             Connectivity::kEight);
}

int MatchesOf(const DisparityMap& disparity) {
  return static_cast<int>(std::count_if(disparity.data().begin(), disparity.data().end(),
                                        [](float d) { return !std::isnan(d); }));
}

TEST(Sad5Thesis, EqualsItsDefinitionBitForBit) {
  const test::Pair pair = Noisy(70, 40);
  for (const int window : {kSmallWindow, 9}) {
    const MatcherOptions options = WithWindow(window);
    const DisparityMap disparity = MakeMatcher("sad5-thesis", options)->Match(pair.left, pair.right);
    const DisparityMap expected = SlowlyAsPrinted(pair, options, 0);
    EXPECT_THAT(disparity.data(), testing::Pointwise(testing::NanSensitiveFloatEq(), expected.data()));
    EXPECT_GT(MatchesOf(disparity), 0);
  }
}

TEST(Sad5Thesis, KeepsNoMatchWhoseRightPixelIsOffByOne) {
  const test::Pair pair = Noisy(70, 40);
  MatcherOptions options = WithWindow(kSmallWindow);
  options.sad5.speckle_pixels = 0;
  const DisparityMap strict = MakeMatcher("sad5-thesis", options)->Match(pair.left, pair.right);
  const DisparityMap tolerant = SlowlyAsPrinted(pair, options, 1);
  for (std::size_t i = 0; i < strict.data().size(); ++i) {
    if (std::isnan(strict.data()[i])) continue;
    ASSERT_EQ(strict.data()[i], tolerant.data()[i]);
  }
  EXPECT_LT(MatchesOf(strict), MatchesOf(tolerant));
}

TEST(Sad5Thesis, TruncatesOnlyWhereScoresWouldNotFit) {
  for (const auto& [window, cut] : {std::pair{7, 255}, {9, 255}, {11, 180}, {21, 49}}) {
    MatcherOptions options = WithWindow(window);
    options.sad5 = AsTheThesisPrints(options.sad5);
    EXPECT_EQ(Sad5(options).cut(), cut) << window;
  }
}

TEST(Sad5Thesis, WhatIsPrintedIsFixedAndTheRestIsTaken) {
  MatcherOptions options = WithWindow(9);
  options.sad5.uniqueness = 0.05;
  options.sad5.speckle_pixels = 10;
  const test::Pair pair = Noisy(70, 40);
  const DisparityMap disparity = MakeMatcher("sad5-thesis", options)->Match(pair.left, pair.right);
  EXPECT_GT(MatchesOf(disparity), 0);
  MatcherOptions other = options;
  other.sad5.prefilter.kind = Prefilter::kNone;
  other.sad5.prefilter.bilateral_sigma_range = 50.0;
  other.sad5.max_difference = 1;
  other.sad5.left_right = 5;
  EXPECT_THAT(MakeMatcher("sad5-thesis", other)->Match(pair.left, pair.right).data(),
              testing::Pointwise(testing::NanSensitiveFloatEq(), disparity.data()));
  other.sad5.speckle_pixels = 1000000;
  EXPECT_EQ(MatchesOf(MakeMatcher("sad5-thesis", other)->Match(pair.left, pair.right)), 0);
}

}  // namespace
}  // namespace thalweg::stereo
