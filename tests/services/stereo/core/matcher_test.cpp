#include "services/stereo/core/matcher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

#include "tests/support/random_images.h"

namespace thalweg::stereo {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kPairWidth = 200;
constexpr int kPairHeight = 100;
constexpr int kMargin = 30;  // where windows reach beyond the image

class EveryEngine : public testing::TestWithParam<std::string> {
 public:
  static DisparityMap Match(const ByteImage& left, const ByteImage& right, int max_disparity = 32) {
    MatcherOptions options;
    options.max_disparity = max_disparity;
    return MakeMatcher(GetParam(), options)->Match(left, right);
  }
};

/// OpenCV's matchers are there for comparison only: StereoSGBM finds disparity 0 in blank images, StereoBM
/// rejects small ones.
class OurEngine : public EveryEngine {};

int MatchesIn(const DisparityMap& disparity) {
  int matches = 0;
  for (const float d : disparity.data()) matches += std::isnan(d) ? 0 : 1;
  return matches;
}

TEST_P(EveryEngine, FindsTheShiftOfAShiftedImage) {
  for (const int shift : {0, 1, 9, 24}) {
    const test::Pair pair = test::PlanePair(kPairWidth, kPairHeight, 0.0, 0.0, shift, 11);
    const DisparityMap disparity = Match(pair.left, pair.right);
    for (int v = kMargin; v < kPairHeight - kMargin; ++v) {
      for (int u = kMargin + 24; u < kPairWidth - kMargin; ++u) {
        ASSERT_NEAR(disparity(u, v), shift, 0.25) << "u " << u << " v " << v;
      }
    }
  }
}

TEST_P(EveryEngine, FindsTheSlopeOfASlantedPlaneToATenthOfAPixel) {
  const Eigen::Vector3d truth(0.06, 0.03, 4.0);  // d = x . (u, v, 1)
  const test::Pair pair = test::PlanePair(kPairWidth, kPairHeight, truth[0], truth[1], truth[2], 12);
  const DisparityMap disparity = Match(pair.left, pair.right);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  int count = 0;
  for (int v = kMargin; v < kPairHeight - kMargin; ++v) {
    for (int u = kMargin + 24; u < kPairWidth - kMargin; ++u) {
      if (std::isnan(disparity(u, v))) continue;
      const Eigen::Vector3d x(u, v, 1.0);
      ASSERT_NEAR(disparity(u, v), truth.dot(x), 1.25);
      normal += x * x.transpose();
      right += disparity(u, v) * x;
      ++count;
    }
  }
  EXPECT_GT(count, (kPairWidth - 2 * kMargin - 24) * (kPairHeight - 2 * kMargin) * 9 / 10);
  const Eigen::Vector3d fit = normal.ldlt().solve(right);
  for (const int u : {kMargin, kPairWidth - kMargin}) {
    for (const int v : {kMargin, kPairHeight - kMargin}) {
      EXPECT_NEAR(fit.dot(Eigen::Vector3d(u, v, 1.0)), truth.dot(Eigen::Vector3d(u, v, 1.0)), 0.1);
    }
  }
}

TEST_P(OurEngine, FindsNothingWithoutTexture) {
  EXPECT_EQ(
      MatchesIn(Match(ByteImage(kPairWidth, kPairHeight, 1, 90), ByteImage(kPairWidth, kPairHeight, 1, 90))),
      0);
}

TEST_P(EveryEngine, FindsNothingInSwappedImagesWhateverTheRange) {
  for (const double disparity : {3.0, 6.0, 11.0, 25.0}) {
    const test::Pair pair = test::PlanePair(kPairWidth, kPairHeight, 0.0, 0.01, disparity, 13);
    for (const int range : {8, 16, 32, 64, 128}) {
      if (range <= disparity + 1.0) continue;
      EXPECT_EQ(MatchesIn(Match(pair.right, pair.left, range)), 0) << disparity << " px, range " << range;
      EXPECT_GT(MatchesIn(Match(pair.left, pair.right, range)), kPairWidth * kPairHeight / 2)
          << disparity << " px, range " << range;
    }
  }
}

TEST_P(EveryEngine, TakesColorAsItsLuma) {
  const test::Pair pair = test::PlanePair(kPairWidth, kPairHeight, 0.0, 0.0, 7.0, 14);
  const auto colored = [](const ByteImage& gray) {
    ByteImage color(gray.width(), gray.height(), 3);
    for (std::size_t i = 0; i < gray.data().size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) color.data()[3 * i + k] = gray.data()[i];
    }
    return color;
  };
  EXPECT_THAT(Match(colored(pair.left), colored(pair.right)).data(),
              testing::Pointwise(testing::NanSensitiveFloatEq(), Match(pair.left, pair.right).data()));
}

TEST_P(EveryEngine, RefusesPairsThatAreNone) {
  const ByteImage image(40, 30);
  EXPECT_THAT([&] { Match(image, ByteImage(40, 31)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("40 x 31")));
  EXPECT_THAT([&] { Match(image, ByteImage(40, 30, 3)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("3")));
  EXPECT_THAT([&] { Match(ByteImage(), ByteImage()); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("0 x 0")));
}

TEST_P(OurEngine, TakesImagesSmallerThanItsWindowAndItsRange) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{3, 40}, std::pair{40, 2}}) {
    const ByteImage image = test::RandomImage(width, height, 15);
    EXPECT_TRUE(Match(image, image).SameSizeAs(image));
  }
}

std::string NameOf(const testing::TestParamInfo<std::string>& engine) {
  std::string name = engine.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
const auto kOurs =
    testing::Values("sad5-dog", "sad5-log", "sad5-bilateral", "sad5-none", "sad5-thesis", "best");
INSTANTIATE_TEST_SUITE_P(Ours, EveryEngine, kOurs, NameOf);
INSTANTIATE_TEST_SUITE_P(Ours, OurEngine, kOurs, NameOf);
INSTANTIATE_TEST_SUITE_P(OpenCv, EveryEngine, testing::Values("opencv-bm", "opencv-sgbm"), NameOf);

TEST(WhyNoMatches, DistinguishesSwappedImagesFromBlankOnes) {
  const test::Pair pair = test::PlanePair(kPairWidth, kPairHeight, 0.0, 0.0, 6.0, 17);
  const DisparityMap none(kPairWidth, kPairHeight, 1, kNoDisparity);
  EXPECT_THAT(WhyNoMatches(none, pair.right, pair.left, 32), HasSubstr("swapped"));
  EXPECT_THAT(WhyNoMatches(none, pair.left, pair.left, 32), HasSubstr("not below 32"));
  EXPECT_EQ(WhyNoMatches(DisparityMap(kPairWidth, kPairHeight, 1, 6.0F), pair.right, pair.left, 32), "");
}

TEST(MakeMatcher, MakesEveryEngineThatItNames) {
  const test::Pair pair = test::PlanePair(kPairWidth, kPairHeight, 0.0, 0.0, 5.0, 16);
  for (const std::string_view name : EngineNames()) {
    EXPECT_TRUE(MakeMatcher(name, {})->Match(pair.left, pair.right).SameSizeAs(pair.left)) << name;
  }
}

TEST(MakeMatcher, NamesWhatItDoesNotKnow) {
  EXPECT_THAT([] { MakeMatcher("sgm", {}); }, ThrowsMessage<std::invalid_argument>(HasSubstr("\"sgm\"")));
  MatcherOptions options;
  options.max_disparity = 0;
  EXPECT_THAT([&] { MakeMatcher("best", options); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("max_disparity is 0")));
}

}  // namespace
}  // namespace thalweg::stereo
