#include "services/simulator/core/depth_sensor.h"

#include <gtest/gtest.h>

#include "tests/services/simulator/core/simple_scenes.h"
#include "tests/support/meshes.h"

namespace thalweg::simulator {
namespace {

using test::kAhead;
using test::kSensorBounds;
using test::WallAt;

TEST(DepthSensor, AFlatWallHasOneDepth) {
  DepthSensor sensor({.max_range = 100.0});
  const PointCloud cloud = sensor.Capture(WallAt(2.5), kAhead);
  ASSERT_EQ(cloud.points_C.size(), 10000U);
  ASSERT_EQ(cloud.colors.size(), 10000U);
  for (const Eigen::Vector3f& p : cloud.points_C) ASSERT_NEAR(p.z(), 2.5F, 1e-5F);
}

TEST(DepthSensor, SeesAFurnishedRoomAsTheClosedFormDoes) {
  const auto room = test::AnalyticRoom::Furnished();
  const World world(test::MeshOf(room), kSensorBounds);
  const DepthSensorModel model{.max_range = 5.0};
  DepthSensor sensor(model);
  std::mt19937 random(7);
  int edges = 0;
  for (int view = 0; view < 10; ++view) {
    const RigidTransform T_WC = room.RandomPose(random);
    const PointCloud expected = room.Render(model.camera, T_WC, model.max_range);
    const PointCloud cloud = sensor.Capture(world, T_WC);
    ASSERT_EQ(cloud.points_C.size(), expected.points_C.size());
    for (std::size_t i = 0; i < cloud.points_C.size(); ++i) {
      const bool none = std::isnan(cloud.points_C[i].x()) && std::isnan(expected.points_C[i].x());
      const bool same = none || (cloud.points_C[i] - expected.points_C[i]).norm() < 1e-4F;
      edges += !same;  // a ray that grazes an edge may end in front of it or behind it
    }
  }
  EXPECT_LE(edges, 3);
}

TEST(DepthSensor, BeyondItsRangeAlongTheRayThereIsNoMeasurement) {
  const DepthSensorModel model{.max_range = 3.0};
  DepthSensor sensor(model);
  const PointCloud cloud = sensor.Capture(WallAt(2.8), kAhead);
  int missing = 0;
  for (int v = 0; v < 100; ++v) {
    for (int u = 0; u < 100; ++u) {
      const bool in_range = 2.8 * model.camera.RayAtUnitDepth(u, v).norm() <= 3.0;
      const bool measured = !cloud.points_C[static_cast<std::size_t>(v * 100 + u)].hasNaN();
      ASSERT_EQ(measured, in_range) << u << ' ' << v;
      missing += !measured;
    }
  }
  EXPECT_GT(missing, 1000);
}

TEST(DepthSensor, OneThatCanTellSaysWhereNothingIsInRangeAndElseTheSame) {
  const World world = WallAt(2.8);
  for (const double noise : {0.0, 0.5}) {
    DepthSensor plain({.max_range = 3.0, .disparity_noise_px = noise});
    DepthSensor reporting({.max_range = 3.0, .disparity_noise_px = noise, .no_return_is_free = true});
    const PointCloud expected = plain.Capture(world, kAhead);
    const PointCloud cloud = reporting.Capture(world, kAhead);
    int without_return = 0;
    for (std::size_t k = 0; k < cloud.points_C.size(); ++k) {
      const bool nothing = expected.points_C[k].hasNaN();
      ASSERT_EQ(IsNoReturn(cloud.points_C[k]), nothing) << k;
      if (nothing) {
        ++without_return;
      } else {
        ASSERT_EQ(cloud.points_C[k], expected.points_C[k]) << k;
      }
    }
    EXPECT_GT(without_return, 1000);
  }
}

TEST(DepthSensor, NoiseOfTheDisparityGrowsWithTheSquareOfTheDepth) {
  constexpr double kSigma = 0.25;  // [px]
  for (const double depth : {1.0, 2.0, 4.0}) {
    const DepthSensorModel model{.max_range = 100.0, .disparity_noise_px = kSigma, .baseline = 0.12};
    DepthSensor sensor(model, 3);
    double sum = 0.0;
    double squares = 0.0;
    double disparities = 0.0;
    const PointCloud cloud = sensor.Capture(WallAt(depth), kAhead);
    for (const Eigen::Vector3f& p : cloud.points_C) {
      const double error = double(p.z()) - depth;
      sum += error;
      squares += error * error;
      disparities += model.camera.fx * model.baseline / double(p.z());
    }
    const auto n = static_cast<double>(cloud.points_C.size());
    const double sigma = std::sqrt(squares / n - sum * sum / n / n);
    const double share = kSigma * depth / (model.camera.fx * model.baseline);  // of the disparity
    const double first_order = depth * share;
    EXPECT_NEAR(sigma, first_order, first_order * (0.05 + 8.0 * share * share)) << depth;
    const double true_disparity = model.camera.fx * model.baseline / depth;
    EXPECT_NEAR(disparities / n, true_disparity, 4.0 * kSigma / std::sqrt(n))
        << "unbiased before triangulation";
  }
}

TEST(DepthSensor, NoiseMovesAPointAlongItsRayOnly) {
  const DepthSensorModel model{.max_range = 100.0, .disparity_noise_px = 0.5};
  DepthSensor sensor(model);
  const PointCloud cloud = sensor.Capture(WallAt(2.0), kAhead);
  for (int i = 0; i < 10000; ++i) {
    const Eigen::Vector3f& p = cloud.points_C[static_cast<std::size_t>(i)];
    const Eigen::Vector3d ray = model.camera.RayAtUnitDepth(i % 100, i / 100);
    ASSERT_LT((p.cast<double>() / double(p.z()) - ray).norm(), 1e-5);
  }
}

TEST(DepthSensor, NoiseOfTheImageMovesAPointAlongRowsAndColumnsAndItsDisparityWithTheColumn) {
  constexpr double kSigma = 0.5;  // [px]
  constexpr double kDepth = 1.0;  // [m]
  const DepthSensorModel model{.max_range = 100.0, .image_noise_px = kSigma};
  const PinholeCamera& camera = model.camera;
  DepthSensor sensor(model, 3);
  const PointCloud cloud = sensor.Capture(WallAt(kDepth), kAhead);
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (int i = 0; i < 10000; ++i) {
    const Eigen::Vector3d p_C = cloud.points_C[static_cast<std::size_t>(i)].cast<double>();
    const Eigen::Vector2d moved(camera.fx * p_C.x() / p_C.z() + camera.cx - i % 100,
                                camera.fy * p_C.y() / p_C.z() + camera.cy - i / 100);
    const double disparity_moved = camera.fx * model.baseline * (1.0 / p_C.z() - 1.0 / kDepth);
    ASSERT_NEAR(disparity_moved, moved.x(), 1e-4) << i;
    covariance += moved * moved.transpose() / 10000.0;
  }
  const double tolerance = 4.0 * kSigma * kSigma * std::sqrt(2.0 / 10000.0);
  EXPECT_NEAR(covariance(0, 0), kSigma * kSigma, tolerance);
  EXPECT_NEAR(covariance(1, 1), kSigma * kSigma, tolerance);
  EXPECT_NEAR(covariance(0, 1), 0.0, tolerance);
}

TEST(DepthSensor, TheSameSeedGivesTheSameNoise) {
  const World world = WallAt(3.0);
  const DepthSensorModel model{.disparity_noise_px = 1.0};
  const auto first_depth = [&](std::uint32_t seed) {
    return DepthSensor(model, seed).Capture(world, kAhead).points_C[5050].z();
  };
  EXPECT_EQ(first_depth(4), first_depth(4));
  EXPECT_NE(first_depth(4), first_depth(5));
}

}  // namespace
}  // namespace thalweg::simulator
