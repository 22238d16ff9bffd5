#include "services/mapper/core/ply_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/geometry/triangle.h"
#include "common/voxel/for_each_voxel.h"

namespace thalweg::mapper {
namespace {

using testing::HasSubstr;

constexpr double kEdge = 0.1;
constexpr std::size_t kMostPlyBlocks = 1U << 12U;

Eigen::Vector3d RandomPoint(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

PlyFile CloudOf(std::vector<Eigen::Vector3d> points) {
  PlyFile cloud;
  cloud.points = std::move(points);
  return cloud;
}

PlyFile MeshOf(const std::vector<Triangle>& triangles) {
  PlyFile mesh;
  for (const Triangle& triangle : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), triangle.begin(), triangle.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

std::size_t VoxelsOf(const OccupancyGrid& grid) {
  std::size_t voxels = 0;
  grid.ForEachKnown([&](const VoxelIndex&, float log_odds) {
    EXPECT_EQ(log_odds, kOccupiedOfBt);
    ++voxels;
  });
  return voxels;
}

TEST(PlyMap, VoxelsOfACloudAreThoseThatHoldItsPointsInTheirMeanColor) {
  std::mt19937 random(3);
  PlyFile cloud;
  std::unordered_map<VoxelIndex, std::vector<Rgb>, VoxelIndexHash> expected;
  for (int k = 0; k < 5000; ++k) {
    cloud.points.push_back(RandomPoint(random, 0.8));
    const auto shade = static_cast<std::uint8_t>(random() % 256);
    cloud.colors.push_back({shade, 7, 200});
    const Eigen::Vector3d cell = (cloud.points.back() / kEdge).array().floor();
    expected[{static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())}].push_back(
        cloud.colors.back());
  }
  const auto map = MapOf(cloud, kEdge, kMostPlyBlocks);
  ASSERT_TRUE(map) << map.error();
  EXPECT_EQ(map->grid.voxel_size(), kEdge);
  EXPECT_EQ(VoxelsOf(map->grid), expected.size());
  for (const auto& [voxel, colors] : expected) {
    ASSERT_EQ(map->grid.State(voxel), VoxelState::kOccupied);
    double sum = 0.0;
    for (const Rgb& color : colors) sum += color.r;
    ASSERT_NEAR(map->colors.At(voxel)->r, sum / static_cast<double>(colors.size()), 1.0);
    ASSERT_EQ(map->colors.At(voxel)->g, 7);
  }
}

TEST(PlyMap, VoxelsOfAMeshAreThoseThatClippingLeavesAPartOf) {
  std::mt19937 random(4);
  for (int round = 0; round < 60; ++round) {
    const double reach = round % 3 == 0 ? 0.07 : 0.8;
    const Eigen::Vector3d at = RandomPoint(random, 0.5);
    const Triangle triangle = {at + RandomPoint(random, reach), at + RandomPoint(random, reach),
                               at + RandomPoint(random, reach)};
    const auto map = MapOf(MeshOf({triangle}), kEdge, kMostPlyBlocks);
    ASSERT_TRUE(map) << map.error();
    std::size_t expected = 0;
    ForEachVoxel(CubeAround({0, 0, 0}, 15), [&](const VoxelIndex& i) {
      const Eigen::Vector3d low = kEdge * Eigen::Vector3d(i.x, i.y, i.z);
      const bool is_cut = !ClipToBox(triangle, {low, low + Eigen::Vector3d::Constant(kEdge)}).empty();
      expected += is_cut ? 1 : 0;
      EXPECT_EQ(map->grid.State(i) == VoxelState::kOccupied, is_cut) << i.x << ' ' << i.y << ' ' << i.z;
    });
    EXPECT_EQ(VoxelsOf(map->grid), expected);
  }
}

TEST(PlyMap, AFloorOnTheSideOfVoxelsFillsThoseAboveItAlone) {
  const Triangle floor = {Eigen::Vector3d(0.01, 0.01, 0.0), Eigen::Vector3d(0.98, 0.01, 0.0),
                          Eigen::Vector3d(0.01, 0.98, 0.0)};
  const auto map = MapOf(MeshOf({floor}), kEdge, kMostPlyBlocks);
  ASSERT_TRUE(map);
  EXPECT_EQ(VoxelsOf(map->grid), 55U);
  map->grid.ForEachKnown([](const VoxelIndex& i, float) { EXPECT_EQ(i.z, 0); });
}

TEST(PlyMap, AMeshHasTheColorsOfItsVerticesAndBetweenThemTheirMean) {
  PlyFile mesh = MeshOf({{Eigen::Vector3d(0.05, 0.05, 0.05), Eigen::Vector3d(0.95, 0.05, 0.05),
                          Eigen::Vector3d(0.05, 0.95, 0.05)}});
  mesh.colors = {{0, 0, 0}, {255, 0, 0}, {0, 30, 0}};
  const auto map = MapOf(mesh, kEdge, kMostPlyBlocks);
  ASSERT_TRUE(map);
  EXPECT_EQ(map->colors.At({9, 0, 0}), (Rgb{255, 0, 0}));
  EXPECT_EQ(map->colors.At({4, 3, 0}), (Rgb{85, 10, 0}));
}

TEST(PlyMap, WhatIsBeyondTheGridIsNamed) {
  for (const double x : {3276.81, -3276.81, 1e9, -1e300, std::numeric_limits<double>::max()}) {
    const auto map = MapOf(CloudOf({{0.0, 0.0, 0.0}, {0.0, x, 0.0}}), kEdge, kMostPlyBlocks);
    ASSERT_FALSE(map) << x;
    EXPECT_THAT(map.error(), HasSubstr("beyond 3276.8 m, where the grid of voxels of 0.1 m ends"));
  }
  EXPECT_TRUE(MapOf(CloudOf({{3276.75, -3276.75, 0.0}}), kEdge, kMostPlyBlocks));
  EXPECT_FALSE(MapOf(CloudOf({{0.0, 0.0, 0.0}}), 1e-310, kMostPlyBlocks));
  PlyFile cubes =
      MeshOf({{Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1e300, 0, 0), Eigen::Vector3d(0, 1e300, 0)}});
  cubes.map_voxel_size = kEdge;
  EXPECT_FALSE(MapOf(cubes, kEdge, kMostPlyBlocks));
}

TEST(PlyMap, FewTrianglesCannotTakeUpGigabytes) {
  const auto map = MapOf(MeshOf({{Eigen::Vector3d(-3000, -3000, -3000), Eigen::Vector3d(3000, 0, 0),
                                  Eigen::Vector3d(0, 3000, 3000)}}),
                         kEdge, kMostPlyBlocks);
  ASSERT_FALSE(map);
  EXPECT_THAT(map.error(), HasSubstr("has more than 4096 blocks"));
}

TEST(PlyMap, TheSameTriangleManyTimesCannotTakeForEver) {
  const PlyFile once = MeshOf({{Eigen::Vector3d(0.05, 0.05, 0.05), Eigen::Vector3d(0.75, 0.05, 0.05),
                                Eigen::Vector3d(0.05, 0.75, 0.05)}});
  EXPECT_TRUE(MapOf(once, kEdge, 1));
  PlyFile often = once;
  often.triangles.resize(10'000, once.triangles.front());
  const auto map = MapOf(often, kEdge, 1);
  ASSERT_FALSE(map);
  EXPECT_THAT(map.error(), HasSubstr("has triangles that pass through too many voxels of 0.1 m"));
}

}  // namespace
}  // namespace thalweg::mapper
