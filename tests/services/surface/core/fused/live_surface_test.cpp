#include "services/surface/core/fused/live_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "tests/services/surface/core/fused/volumes.h"

namespace thalweg::surface {
namespace {

constexpr double kLiveVoxel = 0.05;

/// Fuses a view of a wall. @param depth  [m] Before the camera.
void SeeWall(LiveSurface& surface, double depth) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(40, 30, 1.0);
  PointCloud cloud{.width_px = camera.width_px, .height_px = camera.height_px, .points_C = {}, .colors = {}};
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      cloud.points_C.push_back((depth * camera.RayAtUnitDepth(u, v)).cast<float>());
    }
  }
  surface.Fuse(cloud, camera, RigidTransform::Identity());
}

std::vector<VoxelIndex> BlocksWithSurface(const LiveSurface& surface) {
  std::vector<VoxelIndex> blocks;
  for (const auto& [block, mesh] : surface.mesh().blocks()) blocks.push_back(block);
  return blocks;
}

TEST(LiveSurface, HandsOutEachNewBlockOnceWhoeverBroughtTheMeshUpToDate) {
  LiveSurface surface({.voxel_size = kLiveVoxel}, TruncatedVolume(kLiveVoxel));
  EXPECT_TRUE(surface.TakeUpdated().empty());
  SeeWall(surface, 1.5);
  surface.UpdateMesh();  // as for a file
  const std::vector<VoxelIndex> updated = surface.TakeUpdated();
  const std::vector<VoxelIndex> blocks = BlocksWithSurface(surface);
  EXPECT_GT(blocks.size(), 4U);
  for (const VoxelIndex& block : blocks)
    EXPECT_EQ(std::ranges::count(updated, block), 1) << "though a file has them already";
  EXPECT_TRUE(surface.TakeUpdated().empty());
  SeeWall(surface, 1.47);
  EXPECT_FALSE(surface.TakeUpdated().empty());
}

TEST(LiveSurface, WhatItGoesOnFromIsNotNew) {
  TruncatedVolume volume =
      test::VolumeOf(kLiveVoxel, [](int x, int /*y*/, int /*z*/) { return kLiveVoxel * (0.5 - x); });
  LiveSurface surface({.voxel_size = kLiveVoxel}, std::move(volume));
  EXPECT_FALSE(surface.mesh().blocks().empty());
  EXPECT_TRUE(surface.TakeUpdated().empty());
}

}  // namespace
}  // namespace thalweg::surface
