#include "common/geometry/scan_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace thalweg {
namespace {

constexpr int kSide = MeasuredShares::kSide;

/// A cloud in which each pixel lacks a depth with the given probability: one coordinate or all are NaN, since
/// real clouds have both.
PointCloud RandomCloud(int width_px, int height_px, double share_without, std::mt19937& random) {
  PointCloud cloud{.width_px = width_px, .height_px = height_px, .points_C = {}, .colors = {}};
  std::bernoulli_distribution without(share_without);
  for (int k = 0; k < width_px * height_px; ++k) {
    cloud.points_C.emplace_back(0.1F, 0.2F, 1.0F);
    if (!without(random)) continue;
    if (k % 2 == 0) cloud.points_C.back().setConstant(std::numeric_limits<float>::quiet_NaN());
    cloud.points_C.back().z() = std::numeric_limits<float>::quiet_NaN();
  }
  return cloud;
}

TEST(MeasuredShares, AreTheSharesOfMeasuredPixelsOfEachCell) {
  std::mt19937 random(3);
  for (const auto& [width, height] : {std::pair{100, 75}, {8, 8}, {9, 15}, {64, 48}, {33, 250}}) {
    const PointCloud cloud = RandomCloud(width, height, 0.3, random);
    const auto shares = MeasuredShares::Of(cloud);
    ASSERT_TRUE(shares);
    int pixels[kSide][kSide] = {};
    int measured[kSide][kSide] = {};
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        const int row = kSide * v / height;
        const int column = kSide * u / width;
        ++pixels[row][column];
        measured[row][column] += cloud.points_C[static_cast<std::size_t>(v * width + u)].hasNaN() ? 0 : 1;
      }
    }
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        const double expected = static_cast<double>(measured[row][column]) / pixels[row][column];
        EXPECT_NEAR(shares->of_255[static_cast<std::size_t>(row * kSide + column)], 255.0 * expected, 0.5001)
            << width << " x " << height << ": " << row << ' ' << column;
      }
    }
  }
}

TEST(MeasuredShares, AllOrNothingAreExact) {
  std::mt19937 random(4);
  const auto all = MeasuredShares::Of(RandomCloud(20, 13, 0.0, random));
  const auto nothing = MeasuredShares::Of(RandomCloud(20, 13, 1.0, random));
  ASSERT_TRUE(all && nothing);
  for (int k = 0; k < kSide * kSide; ++k) {
    EXPECT_EQ(all->of_255[static_cast<std::size_t>(k)], 255);
    EXPECT_EQ(nothing->of_255[static_cast<std::size_t>(k)], 0);
  }
}

TEST(MeasuredShares, ThatNothingIsWithinRangeIsAMeasurement) {
  const PointCloud cloud{.width_px = 16,
                         .height_px = 16,
                         .points_C = std::vector<Eigen::Vector3f>(256, NoReturn()),
                         .colors = {}};
  const auto shares = MeasuredShares::Of(cloud);
  ASSERT_TRUE(shares);
  for (const std::uint8_t share : shares->of_255) EXPECT_EQ(share, 255);
}

TEST(MeasuredShares, ACloudThatIsNoImageHasNone) {
  std::mt19937 random(5);
  EXPECT_FALSE(MeasuredShares::Of(RandomCloud(5000, 1, 0.1, random)));
  EXPECT_FALSE(MeasuredShares::Of(RandomCloud(7, 100, 0.1, random)));
  EXPECT_FALSE(MeasuredShares::Of(RandomCloud(100, 7, 0.1, random)));
  EXPECT_FALSE(MeasuredShares::Of(PointCloud{}));
}

TEST(MeasuredShares, APointIsInTheCellOfThePixelThatItFallsOn) {
  const PinholeCamera camera{
      .width_px = 100, .height_px = 70, .fx = 80.0, .fy = 90.0, .cx = 40.0, .cy = 33.0};
  MeasuredShares shares;
  for (std::size_t k = 0; k < shares.of_255.size(); ++k) shares.of_255[k] = static_cast<std::uint8_t>(3 * k);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> u_of(-0.5, 99.5);
  std::uniform_real_distribution<double> v_of(-0.5, 69.5);
  std::uniform_real_distribution<double> depth(0.1, 10.0);
  for (int k = 0; k < 2000; ++k) {
    const double u = u_of(random);
    const double v = v_of(random);
    // Cell boundaries fall between pixels only where the size is a multiple of the number of cells.
    const double column = kSide * (u + 0.5) / 100.0;
    const double row = kSide * (v + 0.5) / 70.0;
    const auto share = shares.At(camera, depth(random) * camera.RayAtUnitDepth(u, v));
    ASSERT_TRUE(share) << u << ' ' << v;
    EXPECT_NEAR(*share * 255.0, 3.0 * (std::floor(row) * kSide + std::floor(column)), 1e-9) << u << ' ' << v;
  }
}

TEST(MeasuredShares, TheImagesCornersAreInTheCellsThere) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(100, 100, 1.3);
  MeasuredShares shares;
  shares.of_255.fill(100);
  shares.of_255.front() = 1;
  shares.of_255.back() = 2;
  EXPECT_NEAR(*shares.At(camera, camera.RayAtUnitDepth(-0.499, -0.499)), 1.0 / 255.0, 1e-12);
  EXPECT_NEAR(*shares.At(camera, camera.RayAtUnitDepth(99.499, 99.499)), 2.0 / 255.0, 1e-12);
}

TEST(MeasuredShares, SayNothingOfAPointOutsideTheImage) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(100, 100, 1.3);
  const MeasuredShares shares;
  EXPECT_TRUE(shares.At(camera, {0.0, 0.0, 2.0}));
  EXPECT_FALSE(shares.At(camera, {0.0, 0.0, -2.0}));
  EXPECT_FALSE(shares.At(camera, camera.RayAtUnitDepth(100.0, 50.0)));
  EXPECT_FALSE(shares.At(camera, camera.RayAtUnitDepth(50.0, -1.0)));
}

}  // namespace
}  // namespace thalweg
