#include "common/geometry/cloud_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "common/geometry/depth_image.h"

namespace thalweg {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// A plane through (0, 0, 2).
PointCloud SlantedWall(const PinholeCamera& camera) {
  const Eigen::Vector3d normal_C = Eigen::Vector3d(0.2, 0.1, -1.0).normalized();
  DepthImage depth{camera.width_px, camera.height_px, {}};
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      const double z = 2.0 * normal_C.z() / camera.RayAtUnitDepth(u, v).dot(normal_C);
      depth.depths.push_back(z > 0.0 ? static_cast<float>(z) : kNaN);
    }
  }
  return CloudFrom(depth, camera);
}

TEST(CameraOf, FindsTheCameraWhateverTheErrorOfTheDepths) {
  const PinholeCamera camera{64, 48, 55.0, 57.0, 30.1, 25.2};
  PointCloud cloud = SlantedWall(camera);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> scale(0.7F, 1.4F);
  for (Eigen::Vector3f& p_C : cloud.points_C) p_C *= scale(random);
  for (std::size_t i = 0; i < cloud.points_C.size(); i += 3) cloud.points_C[i].setConstant(kNaN);
  const Result<std::optional<PinholeCamera>> result = CameraOf(cloud);
  ASSERT_TRUE(result) << result.error();
  const std::optional<PinholeCamera>& found = *result;
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->fx, camera.fx, 1e-3);
  EXPECT_NEAR(found->fy, camera.fy, 1e-3);
  EXPECT_NEAR(found->cx, camera.cx, 1e-3);
  EXPECT_NEAR(found->cy, camera.cy, 1e-3);
}

TEST(CameraOf, RefusesWhatNoPinholeCameraTakes) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(40, 30, 1.2);
  PointCloud line = SlantedWall(camera);
  line.width_px = 40 * 30;
  line.height_px = 1;
  EXPECT_EQ(CameraOf(line).error(), "is not organized: 1200 x 1");
  PointCloud moved = SlantedWall(camera);
  std::swap(moved.points_C[3], moved.points_C[700]);
  EXPECT_NE(CameraOf(moved).error().find("is not of one pinhole camera"), std::string::npos);
  PointCloud one_ray = SlantedWall(camera);
  for (Eigen::Vector3f& p_C : one_ray.points_C) p_C = {0.0F, 0.0F, 1.0F};
  EXPECT_FALSE(CameraOf(one_ray));
}

TEST(CameraOf, SaysNothingOfTooFewPoints) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(40, 30, 1.2);
  PointCloud nothing = SlantedWall(camera);
  for (Eigen::Vector3f& p_C : nothing.points_C) p_C.setConstant(kNaN);
  Result<std::optional<PinholeCamera>> found = CameraOf(nothing);
  EXPECT_TRUE(found && !found->has_value());
  EXPECT_TRUE(Fits(camera, nothing));
  nothing.points_C[5] = SlantedWall(camera).points_C[5];
  found = CameraOf(nothing);
  EXPECT_TRUE(found && !found->has_value());
  EXPECT_TRUE(Fits(camera, nothing));
  nothing.points_C[6] = SlantedWall(camera).points_C[5];
  EXPECT_FALSE(Fits(camera, nothing));
}

TEST(SteadyCamera, AnotherOneIsBelievedOnceItHasStayed) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(100, 80, 1.2);
  const PinholeCamera other = PinholeCamera::FromFieldOfView(100, 80, 1.0);
  const PinholeCamera third = PinholeCamera::FromFieldOfView(100, 80, 0.8);
  SteadyCamera steady;
  EXPECT_TRUE(steady.Accepts(camera));
  for (int round = 0; round < 3; ++round) {
    for (int k = 1; k < SteadyCamera::kToStay; ++k) EXPECT_FALSE(steady.Accepts(other)) << k;
    EXPECT_TRUE(steady.Accepts(camera));
  }
  for (int k = 0; k < 3 * SteadyCamera::kToStay; ++k) {
    EXPECT_FALSE(steady.Accepts(k % 2 == 0 ? other : third)) << "they take turns";
  }
  EXPECT_EQ(steady.camera()->fx, camera.fx);
  for (int k = 1; k < SteadyCamera::kToStay; ++k) EXPECT_FALSE(steady.Accepts(other)) << k;
  EXPECT_TRUE(steady.Accepts(other));
  EXPECT_TRUE(steady.Accepts(other));
  EXPECT_FALSE(steady.Accepts(camera));
}

TEST(PointLookedAt, IsTheMeasuredOneNearestToTheAxis) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(11, 9, 1.2);  // principal point: (5, 4)
  PointCloud cloud{.width_px = 11, .height_px = 9, .points_C = {}, .colors = {}};
  for (int v = 0; v < 9; ++v) {
    for (int u = 0; u < 11; ++u) {
      cloud.points_C.push_back((2.0 * camera.RayAtUnitDepth(u, v)).cast<float>());
    }
  }
  const auto pixel = [](int u, int v) { return static_cast<std::size_t>(v * 11 + u); };
  EXPECT_EQ(PointLookedAt(cloud, camera, 8.0), cloud.points_C[pixel(5, 4)]);
  cloud.points_C[pixel(5, 4)].setConstant(std::numeric_limits<float>::quiet_NaN());
  cloud.points_C[pixel(5, 3)] = NoReturn();
  cloud.points_C[pixel(4, 4)] *= 5.0F;  // beyond the range
  EXPECT_EQ(PointLookedAt(cloud, camera, 8.0), cloud.points_C[pixel(6, 4)]);
  EXPECT_EQ(PointLookedAt(cloud, camera, 1.0), std::nullopt);
}

TEST(CameraOf, IsAnotherWhereRaysAreAPixelOff) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(100, 80, 1.2);
  PinholeCamera nearly = camera;
  nearly.fx *= 1.005;
  EXPECT_TRUE(IsSameCamera(camera, nearly));
  PinholeCamera other = camera;
  other.fx *= 1.05;
  EXPECT_FALSE(IsSameCamera(camera, other));
  PinholeCamera smaller = camera;
  smaller.width_px = 99;
  EXPECT_FALSE(IsSameCamera(camera, smaller));
}

}  // namespace
}  // namespace thalweg
