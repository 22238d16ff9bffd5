#include "common/geometry/pinhole_camera.h"

#include <gtest/gtest.h>

#include <random>

#include "common/base/angles.h"

namespace thalweg {
namespace {

TEST(PinholeCamera, FieldOfViewSpansTheOuterEdgesOfTheFirstAndLastPixel) {
  const double fov = 75.0 * kDegree;
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(100, 80, fov);
  EXPECT_NEAR(camera.RayAtUnitDepth(-0.5, 0.0).x(), -std::tan(0.5 * fov), 1e-12);
  EXPECT_NEAR(camera.RayAtUnitDepth(99.5, 0.0).x(), std::tan(0.5 * fov), 1e-12);
  EXPECT_NEAR(camera.RayAtUnitDepth(0.0, -0.5).y(), -0.8 * std::tan(0.5 * fov), 1e-12);  // square pixels
}

TEST(PinholeCamera, SeesAPointExactlyWhenItProjectsIntoTheImageInFrontOfIt) {
  const PinholeCamera camera{.width_px = 64, .height_px = 48, .fx = 50.0, .fy = 60.0, .cx = 30.0, .cy = 25.0};
  std::mt19937 random(2);
  std::uniform_real_distribution<double> pixel(-40.0, 100.0);
  std::uniform_real_distribution<double> depth(0.1, 10.0);
  for (int k = 0; k < 2000; ++k) {
    const double u = pixel(random);
    const double v = pixel(random);
    const Eigen::Vector3d p_C = depth(random) * camera.RayAtUnitDepth(u, v);
    EXPECT_EQ(camera.Sees(p_C), u >= -0.5 && u < 63.5 && v >= -0.5 && v < 47.5) << u << ' ' << v;
    EXPECT_FALSE(camera.Sees(-p_C));
    const auto projected = camera.Project(p_C);
    ASSERT_EQ(projected.has_value(), camera.Sees(p_C));
    if (!projected) continue;
    EXPECT_LT((*projected - Eigen::Vector2d(u, v)).norm(), 1e-9);
  }
  EXPECT_FALSE(camera.Sees(Eigen::Vector3d::Zero()));
}

}  // namespace
}  // namespace thalweg
