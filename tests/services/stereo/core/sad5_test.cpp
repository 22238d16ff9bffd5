#include "services/stereo/core/sad5.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "services/stereo/core/checks.h"
#include "tests/services/stereo/support/slow_reference.h"
#include "tests/support/random_images.h"

namespace thalweg::stereo {
namespace {

using test::RandomImage;

struct Case {
  int width, height, max_disparity, window, max_difference;
};

class Sad5OnRandomImages : public testing::TestWithParam<Case> {};

TEST_P(Sad5OnRandomImages, EqualsTheDirectSumBitForBit) {
  const Case& c = GetParam();
  const ByteImage left = RandomImage(c.width, c.height, 1);
  const ByteImage right = RandomImage(c.width, c.height, 2);
  MatcherOptions options;
  options.max_disparity = c.max_disparity;
  options.sad5.window = c.window;
  options.sad5.max_difference = c.max_difference;
  const Sad5 sad5(options);
  int rows = 0;
  sad5.ScoreRows(left, right, 0, c.height, [&](int v, const std::uint16_t* scores) {
    EXPECT_EQ(v, rows++);
    for (int u = 0; u < c.width; ++u) {
      for (int d = 0; d < c.max_disparity; ++d) {
        ASSERT_EQ(scores[u * sad5.stride() + d], test::SlowSad5(left, right, u, v, d, c.window, sad5.cut()))
            << "u " << u << " v " << v << " d " << d;
      }
    }
  });
  EXPECT_EQ(rows, c.height);
}

TEST_P(Sad5OnRandomImages, ChecksEqualTheirDefinitions) {
  const Case& c = GetParam();
  const test::Pair pair = test::PlanePair(c.width, c.height, 0.0, 0.0, c.max_disparity / 3, 3);
  ByteImage left = pair.left;
  const ByteImage noise = RandomImage(c.width, c.height, 4);
  for (std::size_t i = 0; i < left.data().size(); i += 3) left.data()[i] = noise.data()[i];
  MatcherOptions options;
  options.max_disparity = c.max_disparity;
  options.sad5.window = c.window;
  options.sad5.max_difference = c.max_difference;
  options.sad5.prefilter.kind = Prefilter::kNone;
  options.sad5.speckle_pixels = 0;
  Sad5 sad5(options);
  const DisparityMap disparity = sad5.Match(left, pair.right);
  for (int v = 0; v < c.height; ++v) {
    std::vector<test::Costs> costs;
    for (int u = 0; u < c.width; ++u) {
      costs.emplace_back();
      for (int d = 0; d < c.max_disparity; ++d) {
        costs.back().push_back(test::SlowSad5(left, pair.right, u, v, d, c.window, sad5.cut()));
      }
    }
    const std::vector<float> expected =
        test::SlowChoose(costs, options.sad5.uniqueness, options.sad5.left_right, true);
    const std::vector<float> row(disparity.Row(v), disparity.Row(v) + c.width);
    ASSERT_THAT(row, testing::Pointwise(testing::NanSensitiveFloatEq(), expected)) << "row " << v;
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, Sad5OnRandomImages,
                         testing::Values(Case{37, 29, 16, 11, 255}, Case{40, 24, 33, 7, 20},
                                         Case{23, 45, 64, 21, 255}, Case{5, 3, 8, 9, 60}));

TEST(Sad5, OneThreadAndManyAgree) {
  const test::Pair pair = test::PlanePair(150, 120, 0.05, 0.0, 5.0, 5);
  MatcherOptions options;
  options.max_disparity = 32;
  options.threads = 1;
  const DisparityMap one = Sad5(options).Match(pair.left, pair.right);
  options.threads = 3;
  const DisparityMap many = Sad5(options).Match(pair.left, pair.right);
  EXPECT_THAT(many.data(), testing::Pointwise(testing::NanSensitiveFloatEq(), one.data()));
}

TEST(Sad5, RefusesAWindowThatIsEvenOrTooLarge) {
  for (const int window : {5, 10, 23}) {
    MatcherOptions options;
    options.sad5.window = window;
    EXPECT_THROW(Sad5{options}, std::invalid_argument) << window;
  }
}

}  // namespace
}  // namespace thalweg::stereo
