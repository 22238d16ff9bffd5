#include "services/stereo/core/prefilter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

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

/// Computes the image minus its bilateral blur directly from the definition.
TEST(Prefilter, BilateralEqualsItsDefinition) {
  const ByteImage image = test::PlanePair(60, 50, 0.0, 0.0, 0.0, 3).left;
  PrefilterOptions options = Of(Prefilter::kBilateral);
  options.bilateral_sigma_distance = 2.0;
  options.bilateral_sigma_range = 20.0;
  const ByteImage out = Filter(image, options);
  const int radius = 3;  // OpenCV's choice: 1.5 sigma
  for (int v = 10; v < 40; ++v) {
    for (int u = 10; u < 50; ++u) {
      double sum = 0.0;
      double weights = 0.0;
      for (int j = -radius; j <= radius; ++j) {
        for (int i = -radius; i <= radius; ++i) {
          if (i * i + j * j > radius * radius) continue;
          const double difference = image(u + i, v + j) - image(u, v);
          const double weight =
              std::exp(-0.5 * (i * i + j * j) / 4.0 - 0.5 * difference * difference / 400.0);
          sum += weight * image(u + i, v + j);
          weights += weight;
        }
      }
      ASSERT_NEAR(out(u, v), 128.0 + image(u, v) - sum / weights, 1.01) << u << ' ' << v;
    }
  }
}

}  // namespace
}  // namespace thalweg::stereo
