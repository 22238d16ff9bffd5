#include "services/stereo/core/prefilter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "tests/support/random_images.h"

namespace thalweg::stereo {
namespace {

PrefilterOptions Of(Prefilter kind) {
  PrefilterOptions options;
  options.kind = kind;
  return options;
}

TEST(Prefilter, NoneLeavesTheImage) {
  const ByteImage image = test::RandomImage(20, 10, 1);
  EXPECT_EQ(Filter(image, Of(Prefilter::kNone)), image);
}

TEST(Prefilter, BrightnessIsTakenAway) {
  ByteImage image = test::RandomImage(40, 30, 2);
  for (std::uint8_t& value : image.data()) value /= 2;
  ByteImage brighter = image;
  for (std::uint8_t& value : brighter.data()) value = static_cast<std::uint8_t>(value + 100);
  for (const Prefilter kind :
       {Prefilter::kDifferenceOfGaussians, Prefilter::kLaplacianOfGaussian, Prefilter::kBilateral}) {
    const ByteImage a = Filter(image, Of(kind));
    const ByteImage b = Filter(brighter, Of(kind));
    for (std::size_t i = 0; i < a.data().size(); ++i) ASSERT_NEAR(a.data()[i], b.data()[i], 1);
    EXPECT_THAT(Filter(ByteImage(20, 10, 1, 77), Of(kind)).data(), testing::Each(128));
  }
}

/// Compares the response to a single bright pixel with the formula.
TEST(Prefilter, ResponsesAreThoseOfTheGaussians) {
  ByteImage image(41, 41);
  image(20, 20) = 255;
  PrefilterOptions options = Of(Prefilter::kDifferenceOfGaussians);
  options.dog_sigma = 2.0;
  options.gain = 20.0;
  const ByteImage out = Filter(image, options);
  const auto gaussian = [](double sigma, double square) {
    return std::exp(-0.5 * square / (sigma * sigma)) / (2.0 * std::acos(-1.0) * sigma * sigma);
  };
  for (int v = 14; v <= 26; ++v) {
    for (int u = 14; u <= 26; ++u) {
      const double square = (u - 20) * (u - 20) + (v - 20) * (v - 20);
      const double expected = 128.0 + 20.0 * 255.0 * (gaussian(2.0, square) - gaussian(3.2, square));
      EXPECT_NEAR(out(u, v), expected, 2.0) << u << ' ' << v;
    }
  }
}

TEST(Prefilter, LaplacianIsPositiveInABrightSpotAndNegativeAround) {
  ByteImage image(21, 21, 1, 50);
  image(10, 10) = 150;
  const ByteImage out = Filter(image, Of(Prefilter::kLaplacianOfGaussian));
  EXPECT_GT(out(10, 10), 128);
  EXPECT_LT(out(12, 10), 128);
  EXPECT_EQ(out(1, 1), 128);
}

/// The bilateral blur of one pixel, from its definition; neighbors within 1.5 sigma count, as OpenCV has it.
double BilateralBlurAt(const ByteImage& image, int u, int v, const PrefilterOptions& options) {
  const double sigma_d = options.bilateral_sigma_distance;
  const double sigma_r = options.bilateral_sigma_range;
  const int radius = static_cast<int>(std::lround(1.5 * sigma_d));
  double sum = 0.0;
  double weights = 0.0;
  for (int j = -radius; j <= radius; ++j) {
    for (int i = -radius; i <= radius; ++i) {
      if (i * i + j * j > radius * radius) continue;
      const double difference = image(u + i, v + j) - image(u, v);
      const double weight = std::exp(-0.5 * (i * i + j * j) / (sigma_d * sigma_d) -
                                     0.5 * difference * difference / (sigma_r * sigma_r));
      sum += weight * image(u + i, v + j);
      weights += weight;
    }
  }
  return sum / weights;
}

TEST(Prefilter, BilateralIsTheImageMinusItsBlur) {
  const ByteImage image = test::PlanePair(60, 50, 0.0, 0.0, 0.0, 3).left;
  PrefilterOptions options = Of(Prefilter::kBilateral);
  options.bilateral_sigma_distance = 2.0;
  options.bilateral_sigma_range = 20.0;
  const ByteImage out = Filter(image, options);
  for (int v = 10; v < 40; ++v) {
    for (int u = 10; u < 50; ++u) {
      ASSERT_NEAR(out(u, v), 128.0 + image(u, v) - BilateralBlurAt(image, u, v, options), 1.01)
          << u << ' ' << v;
    }
  }
}

TEST(Prefilter, BilateralBlurEqualsItsDefinition) {
  const ByteImage image = test::PlanePair(60, 50, 0.0, 0.0, 0.0, 3).left;
  for (const auto& [distance, range] : {std::pair{10.0, 5.0}, std::pair{2.0, 20.0}}) {
    PrefilterOptions options = Of(Prefilter::kBilateralBlur);
    options.bilateral_sigma_distance = distance;
    options.bilateral_sigma_range = range;
    const ByteImage out = Filter(image, options);
    int changed = 0;
    for (int v = 15; v < 35; ++v) {
      for (int u = 15; u < 45; ++u) {
        ASSERT_NEAR(out(u, v), BilateralBlurAt(image, u, v, options), 0.51) << u << ' ' << v;
        changed += out(u, v) != image(u, v) ? 1 : 0;
      }
    }
    EXPECT_GT(changed, 20 * 30 / 4);
  }
}

TEST(Prefilter, BilateralBlurKeepsBrightness) {
  EXPECT_THAT(Filter(ByteImage(20, 10, 1, 77), Of(Prefilter::kBilateralBlur)).data(), testing::Each(77));
}

}  // namespace
}  // namespace thalweg::stereo
