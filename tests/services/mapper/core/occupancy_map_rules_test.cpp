#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "common/voxel/ray.h"
#include "services/mapper/core/occupancy_map.h"
#include "tests/services/mapper/core/small_clouds.h"
#include "tests/support/analytic_room.h"

namespace thalweg::mapper {
namespace {

using test::AnalyticRoom;
using test::kNaN;
using test::LevelPose;
using test::SinglePoint;

/// A room so large that only its wall x = `x` can be in view.
AnalyticRoom WallAt(double x) {
  return {Eigen::AlignedBox3d(Eigen::Vector3d(-50, -50, -50), Eigen::Vector3d(x, 50, 50)), {}};
}

TEST(OccupancyMap, UnorganizedCloudsAreTakenWithoutFill) {
  OccupancyMap filled(
      OccupancyMap::Options{.protect = false, .fill = true, .exact_rays = false, .shadow = 0.0});
  OccupancyMap plain(OccupancyMap::Options::OfOctomap());
  PointCloud cloud =
      AnalyticRoom::Furnished().Render(PinholeCamera::FromFieldOfView(30, 30, 1.3), LevelPose());
  cloud.width_px *= cloud.height_px;
  cloud.height_px = 1;
  filled.Integrate(cloud, LevelPose());
  plain.Integrate(cloud, LevelPose());
  EXPECT_TRUE(filled.grid().SameAs(plain.grid()));
}

// ---- protect ---------------------------------------------------------------------------------------

/// Voxels of the wall y = 0.537, near the sensor, that are occupied after a look from the front, and of
/// those, after ten looks along the wall, whose rays cross far more of its voxels than they hit.
struct GrazedWall {
  std::size_t seen = 0;
  std::size_t left = 0;
};

GrazedWall GrazeWall(bool protect) {
  const AnalyticRoom room{Eigen::AlignedBox3d(Eigen::Vector3d(-40, -40, -40), Eigen::Vector3d(40, 0.537, 40)),
                          {}};
  OccupancyMap map(
      OccupancyMap::Options{.protect = protect, .fill = false, .exact_rays = false, .shadow = 0.0});
  const auto count = [&map] {
    std::size_t occupied = 0;
    map.grid().ForEachKnown([&](const VoxelIndex& i, float log_odds) {
      occupied += i.y == 5 && i.x >= 4 && i.x < 10 && std::abs(i.z) < 4 && log_odds >= 0.0F ? 1 : 0;
    });
    return occupied;
  };
  const RigidTransform facing =
      MakeTransform(RotationFromYawPitch(1.5708, 0.0) * BodyFromOptical(), {0.7, -0.7, 0.05});
  map.Integrate(room.Render(PinholeCamera::FromFieldOfView(120, 120, 1.3), facing), facing);
  GrazedWall wall{.seen = count()};
  const RigidTransform along =
      MakeTransform(RotationFromYawPitch(0.15, 0.0) * BodyFromOptical(), {0.03, 0.413, 0.05});
  const PointCloud cloud = room.Render(PinholeCamera::FromFieldOfView(60, 60, 1.3), along);
  for (int scan = 0; scan < 10; ++scan) map.Integrate(cloud, along);
  wall.left = count();
  return wall;
}

TEST(OccupancyMap, ProtectKeepsAGrazedWall) {
  const GrazedWall plain = GrazeWall(false);
  EXPECT_EQ(plain.seen, 42u);
  EXPECT_LT(plain.left, plain.seen);
  const GrazedWall kept = GrazeWall(true);
  EXPECT_EQ(kept.seen, 42u);
  EXPECT_EQ(kept.left, kept.seen);
}

TEST(OccupancyMap, ProtectStillLetsAVanishedThingBeCleared) {
  OccupancyMap map(OccupancyMap::Options{.protect = true, .fill = false, .exact_rays = false, .shadow = 0.0});
  const VoxelIndex thing = map.grid().IndexOf({2.03, 0.04, 0.05});
  for (int scan = 0; scan < 5; ++scan) map.Integrate(SinglePoint(2.0F), LevelPose());
  EXPECT_EQ(map.grid().State(thing), VoxelState::kOccupied);
  for (int scan = 0; scan < 20; ++scan) map.Integrate(SinglePoint(3.0F), LevelPose());
  EXPECT_EQ(map.grid().State(thing), VoxelState::kFree);
}

TEST(OccupancyMap, ProtectHoldsExactlyBesideAHitOfTheSameScan) {
  OccupancyMap map(OccupancyMap::Options{.protect = true, .fill = false, .exact_rays = false, .shadow = 0.0});
  const VoxelIndex thing = map.grid().IndexOf({2.03, 0.04, 0.05});
  for (int scan = 0; scan < 5; ++scan) map.Integrate(SinglePoint(2.0F), LevelPose());
  const float before = map.grid().LogOdds(thing);
  map.Integrate(SinglePoint(2.1F), LevelPose());  // the next voxel is a 26-neighbor
  EXPECT_EQ(map.grid().LogOdds(thing), before);
  map.Integrate(SinglePoint(2.2F), LevelPose());  // the one behind it is not
  EXPECT_NEAR(map.grid().LogOdds(thing), before - 0.4F, 1e-5);
}

// ---- fill ------------------------------------------------------------------------------------------

/// The voxels that a wall crosses in view, and how many of them are not occupied.
struct WallVoxels {
  std::size_t holes = 0;
  std::size_t all = 0;
};

/// Looks once, with n x n pixels and from 2 m away, at a wall rotated by `yaw` against the camera.
WallVoxels LookAtSlantedWall(double yaw, int n, bool fill) {
  OccupancyMap map(OccupancyMap::Options{
      .protect = false, .fill = fill, .exact_rays = false, .fill_max_gap = 2.0, .shadow = 0.0});
  const RigidTransform T_WC = LevelPose(yaw);
  const auto camera = PinholeCamera::FromFieldOfView(n, n, 1.309);
  constexpr double kWall = 2.05;  // through the middle of the voxels x = 20
  map.Integrate(WallAt(kWall).Render(camera, T_WC), T_WC);
  const auto in_view = [&](const Eigen::Vector3d& p_W) {
    const Eigen::Vector3d p_C = T_WC.inverse() * p_W;
    if (p_C.z() <= 0.0 || p_C.norm() >= 4.0) return false;
    const double u = camera.fx * p_C.x() / p_C.z() + camera.cx;
    const double v = camera.fy * p_C.y() / p_C.z() + camera.cy;
    return u >= 0 && v >= 0 && u <= n - 1 && v <= n - 1;
  };
  WallVoxels result;
  for (int y = -60; y < 60; ++y) {
    for (int z = -60; z < 60; ++z) {
      bool whole = true;
      for (const int corner : {0, 1, 2, 3}) {
        whole = whole && in_view({kWall, (y + corner % 2) * 0.1, (z + corner / 2) * 0.1});
      }
      if (!whole) continue;
      ++result.all;
      result.holes += map.grid().State({20, y, z}) == VoxelState::kOccupied ? 0 : 1;
    }
  }
  return result;
}

TEST(OccupancyMap, FillLeavesNoHolesInASlantedWallOfSparsePixels) {
  for (const double yaw : {0.0, 0.3, 0.6, -0.5}) {
    const WallVoxels plain = LookAtSlantedWall(yaw, 24, false);
    EXPECT_GT(plain.all, 800u);
    EXPECT_GT(plain.holes, plain.all / 3);
    EXPECT_EQ(LookAtSlantedWall(yaw, 24, true).holes, 0u) << "yaw " << yaw;
  }
}

TEST(OccupancyMap, FillDoesNotBridgeADepthEdge) {
  OccupancyMap map(OccupancyMap::Options{
      .protect = false, .fill = true, .exact_rays = false, .fill_max_gap = 0.4, .shadow = 0.0});
  AnalyticRoom room = WallAt(2.05);
  // The box's front stands 0.25 m before the wall, which is less than fill_max_gap.
  const Eigen::AlignedBox3d box(Eigen::Vector3d(1.80, -0.42, -0.38), Eigen::Vector3d(1.84, 0.53, 0.47));
  room.boxes.push_back(box);
  std::size_t occupied = 0;
  for (const double yaw : {-0.3, 0.0, 0.2}) {
    map.Integrate(room.Render(PinholeCamera::FromFieldOfView(60, 60, 1.309), LevelPose(yaw)), LevelPose(yaw));
  }
  map.grid().ForEachKnown([&](const VoxelIndex& i, float log_odds) {
    if (log_odds < 0.0F) return;
    ++occupied;
    const Eigen::Vector3d low(i.x * 0.1, i.y * 0.1, i.z * 0.1);
    const Eigen::AlignedBox3d voxel(low, low + Eigen::Vector3d::Constant(0.1));
    EXPECT_TRUE(i.x == 20 || voxel.intersects(box)) << i.x << ' ' << i.y << ' ' << i.z;
  });
  EXPECT_GT(occupied, 500u);
}

TEST(OccupancyMap, FillNeedsAThirdPixelOnThePlane) {
  PointCloud pair{.width_px = 2, .height_px = 2, .points_C = {}, .colors = {}};
  pair.points_C = {{0.0F, 0.0F, 2.0F}, {0.3F, 0.0F, 2.0F}, {kNaN, kNaN, kNaN}, {kNaN, kNaN, kNaN}};
  OccupancyMap map(OccupancyMap::Options{.protect = false, .fill = true, .exact_rays = false, .shadow = 0.0});
  map.Integrate(pair, LevelPose());
  EXPECT_NE(map.grid().State(map.grid().IndexOf({2.03, -0.11, 0.05})), VoxelState::kOccupied);
  PointCloud triple{.width_px = 3, .height_px = 2, .points_C = {}, .colors = {}};
  triple.points_C.assign(6, Eigen::Vector3f::Constant(kNaN));
  for (int u = 0; u < 3; ++u)
    triple.points_C[static_cast<std::size_t>(u)] = {0.3F * static_cast<float>(u), 0, 2};
  map.Integrate(triple, LevelPose());
  EXPECT_EQ(map.grid().State(map.grid().IndexOf({2.03, -0.11, 0.05})), VoxelState::kOccupied);
}

TEST(OccupancyMap, AThinPlateSeenEdgeOnIsHardlyCalledFreeInItsShadow) {
  AnalyticRoom room = WallAt(4.05);
  const Eigen::AlignedBox3d plate(Eigen::Vector3d(1.53, 0.03, -0.45), Eigen::Vector3d(2.57, 0.07, 0.45));
  room.boxes.push_back(plate);
  const auto freed_in_plate = [&](double shadow) {
    OccupancyMap map(
        OccupancyMap::Options{.protect = false, .fill = false, .exact_rays = true, .shadow = shadow});
    const RigidTransform T_WC = LevelPose(0.0);
    map.Integrate(room.Render(PinholeCamera::FromFieldOfView(100, 100, 1.309), T_WC), T_WC);
    std::size_t freed = 0;
    map.grid().ForEachKnown([&](const VoxelIndex& i, float log_odds) {
      const Eigen::Vector3d low(i.x * 0.1, i.y * 0.1, i.z * 0.1);
      const Eigen::AlignedBox3d voxel(low, low + Eigen::Vector3d::Constant(0.1));
      freed += log_odds < 0.0F && voxel.intersects(plate) ? 1 : 0;
    });
    return freed;
  };
  // Only one ray per voxel casts a shadow, so that most of the plate lies in a shadow, but not all of it.
  EXPECT_GT(freed_in_plate(0.0), 50u);
  EXPECT_LT(freed_in_plate(2.0), freed_in_plate(0.0) / 3);
}

TEST(OccupancyMap, AShadowTakesBackExactlyWhatTheRaysWouldCrossIfTheyWentOn) {
  const AnalyticRoom room = AnalyticRoom::Furnished();
  const RigidTransform T_WC = MakeTransform(LevelPose(0.4).linear(), {1.01, 1.23, 0.77});
  const PointCloud cloud = room.Render(PinholeCamera::FromFieldOfView(48, 36, 1.2), T_WC);
  constexpr double kShadow = 0.7;
  OccupancyMap plain(
      OccupancyMap::Options{.protect = false, .fill = false, .exact_rays = true, .shadow = 0.0});
  OccupancyMap shaded(
      OccupancyMap::Options{.protect = false, .fill = false, .exact_rays = true, .shadow = kShadow});
  plain.Integrate(cloud, T_WC);
  shaded.Integrate(cloud, T_WC);
  // Samples every half millimeter behind the point of each hit voxel.
  OccupancyGrid behind(0.1);
  for (const Hit& hit : plain.hits()) {
    const Eigen::Vector3d p_W = T_WC * cloud.points_C[hit.pixel].cast<double>();
    const Eigen::Vector3d direction = (p_W - T_WC.translation()).normalized();
    for (double at = 0.0; at <= kShadow; at += 0.0005) behind.Set(behind.IndexOf(p_W + at * direction), 1.0F);
  }
  std::size_t taken = 0;
  plain.grid().ForEachKnown([&](const VoxelIndex& i, float log_odds) {
    const VoxelState now = shaded.grid().State(i);
    if (log_odds >= 0.0F) {
      EXPECT_EQ(now, VoxelState::kOccupied);
    } else if (now == VoxelState::kUnknown) {
      ++taken;
    } else {
      EXPECT_NE(behind.State(i), VoxelState::kOccupied) << i.x << ' ' << i.y << ' ' << i.z;
    }
    // A corner that the samples step over may also be kept unknown, but no voxel outside all shadows.
    if (now == VoxelState::kUnknown && behind.State(i) != VoxelState::kOccupied) {
      bool beside = false;
      for (int n = 0; n < 27; ++n) {
        beside |= behind.State(i + VoxelIndex{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1}) == VoxelState::kOccupied;
      }
      EXPECT_TRUE(beside);
    }
  });
  EXPECT_GT(taken, 20u);
}

}  // namespace
}  // namespace thalweg::mapper
