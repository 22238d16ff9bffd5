#include "services/surface/core/fused/live_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "tests/services/surface/core/fused/clouds.h"
#include "tests/services/surface/core/fused/volumes.h"
#include "tests/support/analytic_room.h"

namespace thalweg::surface {
namespace {

using Point = Eigen::Vector3d;

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

/// How much there is of a surface.
struct Extent {
  std::size_t blocks = 0;
  std::size_t vertices = 0;
};

/// A surface that is fed with noisy views of a furnished room, as the service does it: a mesh every few
/// scans.
class ManyScans {
 public:
  void See(const RigidTransform& T_WC) {
    PointCloud cloud = room_.Render(camera_, T_WC);
    for (Eigen::Vector3f& p_C : cloud.points_C)
      p_C /= 1.0F + p_C.z() * static_cast<float>(noise_(random_));  // an error of 1 / z
    live_.Fuse(cloud, camera_, T_WC);
    if (++scans_ % 5 != 0) return;
    live_.TakeUpdated();
    live_.FindRifts();
    live_.TakeChanged();
  }
  Extent extent() {
    live_.UpdateMesh();
    Extent extent{.blocks = live_.surface().volume().block_count()};
    for (const auto& [index, mesh] : live_.mesh().blocks()) extent.vertices += mesh.vertices.size();
    return extent;
  }

 private:
  static constexpr double kSigma = 0.002;  // [1/m]
  thalweg::test::AnalyticRoom room_ = thalweg::test::AnalyticRoom::Furnished();
  PinholeCamera camera_ = PinholeCamera::FromFieldOfView(40, 40, 1.309);
  static constexpr double kVoxelSize = 0.05;  // [m]
  LiveSurface live_{{.voxel_size = kVoxelSize, .depth_error = {.sigma = kSigma}},
                    TruncatedVolume(kVoxelSize)};
  std::mt19937 random_{1};
  std::normal_distribution<double> noise_{0.0, kSigma};
  int scans_ = 0;
};

/// Whether there is hardly more than before: noise puts single points where there were none.
void ExpectHardlyMore(const Extent& now, const Extent& before) {
  EXPECT_LE(now.blocks, before.blocks + before.blocks / 50);
  EXPECT_LE(now.vertices, before.vertices + before.vertices / 50);
}

TEST(LiveSurface, GoingRoundInCirclesAddsHardlyAnythingAfterTheSecondLap) {
  ManyScans scans;
  constexpr int kScansPerLap = 40;
  int k = 0;
  const auto lap = [&] {
    for (const int end = k + kScansPerLap; k < end; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / (kScansPerLap + 0.3);  // no pose comes twice
      scans.See(test::LookingAlong(Point(std::cos(angle), std::sin(angle), 0.2), angle + 1.6,
                                   0.2 * std::sin(2.0 * angle)));
    }
    return scans.extent();
  };
  const Extent first = lap();
  const Extent second = lap();
  EXPECT_GT(second.blocks, first.blocks);
  Extent last;
  for (int i = 0; i < 3; ++i) last = lap();
  ExpectHardlyMore(last, second);
}

TEST(LiveSurface, StandingStillForAThousandScansAddsHardlyAnythingAfterTheFirstHundred) {
  ManyScans scans;
  const auto stand = [&](int count) {
    for (int k = 0; k < count; ++k) scans.See(test::LookingAlong(Point(-2.5, -1.0, 0.2), 3.4, -0.1));
    return scans.extent();
  };
  const Extent hundred = stand(100);
  ExpectHardlyMore(stand(900), hundred);
}

}  // namespace
}  // namespace thalweg::surface
