#include "common/geometry/depth_image.h"

#include <gtest/gtest.h>

#include <cmath>

namespace thalweg {
namespace {

TEST(DepthImage, EachPixelsPointProjectsBackOntoItAtItsDepth) {
  const PinholeCamera camera{.width_px = 8, .height_px = 5, .fx = 7.0, .fy = 9.0, .cx = 3.25, .cy = 2.5};
  DepthImage image{.width_px = 8, .height_px = 5, .depths = {}};
  for (int k = 0; k < 40; ++k) image.depths.push_back(1.0F + 0.1F * static_cast<float>(k));
  const PointCloud cloud = CloudFrom(image, camera);
  ASSERT_EQ(cloud.points_C.size(), 40U);
  EXPECT_EQ(cloud.width_px, 8);
  EXPECT_EQ(cloud.height_px, 5);
  for (int v = 0; v < 5; ++v) {
    for (int u = 0; u < 8; ++u) {
      const auto k = static_cast<std::size_t>(8 * v + u);
      const auto pixel = camera.Project(cloud.points_C[k].cast<double>());
      ASSERT_TRUE(pixel);
      EXPECT_TRUE(pixel->isApprox(Eigen::Vector2d(u, v), 1e-5) ||
                  (*pixel - Eigen::Vector2d(u, v)).norm() < 1e-5);
      EXPECT_EQ(cloud.points_C[k].z(), image.depths[k]);
    }
  }
}

TEST(DepthImage, WhatWasNotMeasuredStaysSoAndWhatMetNothingToo) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(2, 2, 1.0);
  const DepthImage image{
      .width_px = 2, .height_px = 2, .depths = {std::nanf(""), INFINITY, 1.0F, std::nanf("")}};
  const PointCloud cloud = CloudFrom(image, camera);
  EXPECT_TRUE(cloud.points_C[0].array().isNaN().all());
  EXPECT_TRUE(IsNoReturn(cloud.points_C[1]));
  EXPECT_FALSE(cloud.points_C[1].hasNaN());
  EXPECT_TRUE(cloud.points_C[2].allFinite());
}

}  // namespace
}  // namespace thalweg
