#include "services/stereo/core/surface_fill.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/random_images.h"

namespace thalweg::stereo {
namespace {

constexpr int kImageWidth = 80;
constexpr int kImageHeight = 60;

float Plane(int u, int v) {
  return 0.05F * static_cast<float>(u) - 0.02F * static_cast<float>(v) + 10.0F;
}

/// A uniform image with matches on one plane in its left fifth.
DisparityMap MatchesOnTheLeft() {
  DisparityMap disparity(kImageWidth, kImageHeight, 1, kNoDisparity);
  for (int v = 0; v < kImageHeight; ++v) {
    for (int u = 0; u < kImageWidth / 5; ++u) disparity(u, v) = Plane(u, v);
  }
  return disparity;
}

TEST(FillSurfaces, ExtendsThePlaneOfTheMatchesOverAnEvenSurface) {
  DisparityMap disparity = MatchesOnTheLeft();
  disparity(3, 3) = 40.0F;  // an outlier
  FillSurfaces(ByteImage(kImageWidth, kImageHeight, 1, 120), {}, 64.0F, disparity);
  for (int v = 0; v < kImageHeight; ++v) {
    for (int u = 0; u < kImageWidth; ++u) ASSERT_NEAR(disparity(u, v), Plane(u, v), 0.01F) << u << ' ' << v;
  }
}

TEST(FillSurfaces, StopsAtAnEdgeOfTheImage) {
  ByteImage image(kImageWidth, kImageHeight, 1, 120);
  for (int v = 0; v < kImageHeight; ++v) {
    for (int u = 40; u < kImageWidth; ++u) image(u, v) = 160;
  }
  DisparityMap disparity = MatchesOnTheLeft();
  FillSurfaces(image, {}, 64.0F, disparity);
  EXPECT_NEAR(disparity(30, 30), Plane(30, 30), 0.01F);
  EXPECT_TRUE(std::isnan(disparity(60, 30)));
}

TEST(FillSurfaces, LeavesGapsWhereTheMatchesDoNotAgree) {
  DisparityMap disparity(kImageWidth, kImageHeight, 1, kNoDisparity);
  const ByteImage noise = test::RandomImage(kImageWidth, kImageHeight, 1);
  for (int v = 0; v < kImageHeight; v += 3) {
    for (int u = 0; u < kImageWidth; u += 3) disparity(u, v) = static_cast<float>(noise(u, v)) / 4.0F;
  }
  FillSurfaces(ByteImage(kImageWidth, kImageHeight, 1, 120), {}, 64.0F, disparity);
  EXPECT_TRUE(std::isnan(disparity(31, 31)));
}

TEST(FillSurfaces, NeverFillsBeyondTheRange) {
  DisparityMap disparity = MatchesOnTheLeft();
  FillSurfaces(ByteImage(kImageWidth, kImageHeight, 1, 120), {}, 12.0F, disparity);
  for (const float d : disparity.data()) EXPECT_FALSE(d >= 12.0F || d < 0.0F);
}

}  // namespace
}  // namespace thalweg::stereo
