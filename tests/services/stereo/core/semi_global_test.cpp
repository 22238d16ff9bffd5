#include "services/stereo/core/semi_global.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/services/stereo/support/slow_reference.h"
#include "tests/support/random_images.h"

namespace thalweg::stereo {
namespace {

MatcherOptions WithoutClosingSteps(int max_disparity) {
  MatcherOptions options;
  options.max_disparity = max_disparity;
  options.best.fill_surfaces = false;
  options.best.speckle_pixels = 0;
  return options;
}

TEST(SemiGlobal, EqualsTheSlowRecursionOnAllEightPaths) {
  for (const int max_disparity : {13, 40}) {
    const test::Pair pair = test::PlanePair(61, 33, 0.1, 0.05, 3.0, 7);
    ByteImage right = pair.right;
    const ByteImage noise = test::RandomImage(61, 33, 8);
    for (std::size_t i = 0; i < right.data().size(); i += 4) right.data()[i] = noise.data()[i];
    MatcherOptions options = WithoutClosingSteps(max_disparity);
    const DisparityMap expected = test::SlowSemiGlobal(pair.left, right, max_disparity, options.best);
    for (const int threads : {1, 2}) {
      options.threads = threads;
      const DisparityMap disparity = SemiGlobal(options).Match(pair.left, right);
      EXPECT_THAT(disparity.data(), testing::Pointwise(testing::NanSensitiveFloatEq(), expected.data()))
          << max_disparity << " disparities, " << threads << " threads";
    }
  }
}

TEST(SemiGlobal, OneMatcherTakesImagesOfChangingSizes) {
  MatcherOptions options = WithoutClosingSteps(32);
  SemiGlobal matcher(options);
  for (const int width : {90, 40, 120}) {
    const test::Pair pair = test::PlanePair(width, 50, 0.0, 0.0, 6.0, 9);
    const DisparityMap again = SemiGlobal(options).Match(pair.left, pair.right);
    EXPECT_THAT(matcher.Match(pair.left, pair.right).data(),
                testing::Pointwise(testing::NanSensitiveFloatEq(), again.data()));
  }
}

TEST(SemiGlobal, RefusesPenaltiesThatEightBitsCannotHold) {
  MatcherOptions options;
  options.best.jump_penalty = 200;
  EXPECT_THROW(SemiGlobal{options}, std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::stereo
