#include "services/stereo/core/triangulation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace thalweg::stereo {
namespace {

StereoGeometry Camera() {
  return {{64, 48, 50.0, 50.0, 31.5, 23.5}, 0.1};
}

TEST(Triangulate, PointsProjectBackOntoTheirPixelsInBothCameras) {
  const StereoGeometry camera = Camera();
  DisparityMap disparity(64, 48, 1, 4.0F);
  const PointCloud cloud =
      Triangulate(disparity, ByteImage(64, 48, 1, 99), camera, {.max_depth_error = 10.0});
  for (int v = 0; v < 48; v += 7) {
    for (int u = 0; u < 64; u += 7) {
      const Eigen::Vector3f& p = cloud.points_C[static_cast<std::size_t>(v * 64 + u)];
      EXPECT_NEAR(50.0 * p.x() / p.z() + 31.5, u, 1e-3);
      EXPECT_NEAR(50.0 * p.y() / p.z() + 23.5, v, 1e-3);
      EXPECT_NEAR(50.0 * (p.x() - 0.1) / p.z() + 31.5, u - 4.0, 1e-3);
    }
  }
  EXPECT_EQ(cloud.colors[5], (Rgb{99, 99, 99}));
}

TEST(Triangulate, KeepsWhatTheOptionsAllow) {
  const StereoGeometry camera = Camera();  // z = 5 / d
  const TriangulationOptions options{
      .min_depth = 0.5, .max_depth = 10.0, .disparity_error = 0.2, .max_depth_error = 0.16};
  // z^2 / 5 * 0.2 <= 0.16: z <= 2
  EXPECT_NEAR(FarthestDepth(camera, options), 2.0, 1e-9);
  DisparityMap disparity(5, 1);
  disparity.data() = {kNoDisparity, 0.0F, 2.4F, 2.6F, 11.0F};
  const PointCloud cloud = Triangulate(disparity, ByteImage(5, 1, 3), camera, options);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(cloud.points_C[i].hasNaN(), i != 3) << i;
}

}  // namespace
}  // namespace thalweg::stereo
