#include "services/controller/core/path_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/services/controller/support/poses.h"

namespace thalweg::controller {
namespace {

using test::At;

constexpr double kVoxel = 0.1;

Track TrackOf(const std::vector<RigidTransform>& T_WBs) {
  return {T_WBs, {}};
}

/// Continues until the whole track is checked, or something is in the way.
void Finish(PathCheck& check, const OccupancyGrid& map, const Track& track) {
  while (!check.obstacle_W() && check.clear_to() < track.length()) check.Continue(map, track);
}

TEST(PathCheck, AWallThatIsKnownIsFoundWhereTheBodyWouldTouchIt) {
  OccupancyGrid map(kVoxel);
  for (int y = -20; y < 20; ++y) {
    for (int z = -20; z < 20; ++z) map.Set({30, y, z}, 2.0F);
  }
  PathCheck check({.radius = 0.25});
  const Track track = TrackOf({At(0.0), At(6.0)});
  check.Restart(map, track, 0.0);
  Finish(check, map, track);
  ASSERT_TRUE(check.obstacle_W());
  EXPECT_NEAR(check.obstacle_W()->x(), 3.05, 1e-9);
  EXPECT_NEAR(check.clear_to(), 3.0 - 0.25, 0.25 * kVoxel + 1e-9);
  EXPECT_LE(check.clear_to(), 3.0 - 0.25);
}

TEST(PathCheck, UnknownAndFreeVoxelsAndAGapOfTheBodysSizeAreNotInTheWay) {
  OccupancyGrid map(kVoxel);
  for (int z = -20; z < 20; ++z) {
    for (int x = 0; x < 60; ++x) {
      map.Set({x, 2, z}, 2.0F);   // from y = 0.2
      map.Set({x, -3, z}, 2.0F);  // up to y = -0.2
      if (x % 2 == 0) map.Set({x, 0, z}, -2.0F);
    }
  }
  const Track track = TrackOf({At(0.0), At(6.0)});
  PathCheck fits({.radius = 0.2});
  fits.Restart(map, track, 0.0);
  Finish(fits, map, track);
  EXPECT_FALSE(fits.obstacle_W());
  EXPECT_DOUBLE_EQ(fits.clear_to(), track.length());
}

/// Brute force: every occupied voxel against points of the segment 1 mm apart.
bool Touches(const std::vector<VoxelIndex>& occupied, const PathCheck::Body& body, const Eigen::Vector3d& a,
             const Eigen::Vector3d& b) {
  const int steps = std::max(1, static_cast<int>(std::ceil((b - a).norm() / 0.001)));
  for (int k = 0; k <= steps; ++k) {
    const Eigen::Vector3d p = a + (b - a) * (static_cast<double>(k) / steps);
    for (const VoxelIndex& i : occupied) {
      const Eigen::Vector3d low(i.x * kVoxel, i.y * kVoxel, i.z * kVoxel);
      const Eigen::Vector3d nearest = p.cwiseMax(low).cwiseMin(low + Eigen::Vector3d::Constant(kVoxel));
      const Eigen::Vector3d gap = nearest - p;
      const bool cylinder = body.height > 0.0;
      if (cylinder ? gap.head<2>().norm() < body.radius && std::abs(gap.z()) < 0.5 * body.height
                   : gap.norm() < body.radius) {
        return true;
      }
    }
  }
  return false;
}

TEST(PathCheck, AgreesWithBruteForceOnRandomMapsForSpheresAndCylinders) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int> voxel(-8, 8);
  std::uniform_real_distribution<double> at(-0.8, 0.8);
  std::uniform_real_distribution<double> size(0.05, 0.3);
  int touched = 0;
  for (int trial = 0; trial < 400; ++trial) {
    PathCheck::Body body{.radius = size(random), .height = trial % 2 == 0 ? 0.0 : 2.0 * size(random)};
    OccupancyGrid map(kVoxel);
    std::vector<VoxelIndex> occupied;
    for (int k = 0; k < 6; ++k) {
      occupied.push_back({voxel(random), voxel(random), voxel(random)});
      map.Set(occupied.back(), 1.0F);
    }
    const Eigen::Vector3d a(at(random), at(random), at(random));
    const Eigen::Vector3d b(at(random), at(random), at(random));
    if (Touches(occupied, {body.radius + 1e-3, body.height > 0 ? body.height + 2e-3 : 0.0}, a, a)) continue;
    const Track track = TrackOf({At(a.x(), a.y(), a.z()), At(b.x(), b.y(), b.z())});
    PathCheck check(body);
    check.Restart(map, track, 0.0);
    Finish(check, map, track);
    // Between two samples a body may pass a corner by what its outline bulges within half their distance.
    const double bulge = body.radius - std::sqrt(body.radius * body.radius - 0.0125 * 0.0125) + 1e-5;
    const bool surely = Touches(occupied, {body.radius - bulge, std::max(0.0, body.height - 0.026)}, a, b);
    const bool possibly = Touches(occupied, body, a, b);
    EXPECT_TRUE(!surely || check.obstacle_W()) << trial;
    EXPECT_TRUE(possibly || !check.obstacle_W()) << trial;
    touched += check.obstacle_W() ? 1 : 0;
  }
  EXPECT_GT(touched, 50);
  EXPECT_LT(touched, 350);
}

TEST(PathCheck, WhatTheBodyTouchesAlreadyDoesNotHoldItButMoreOfItDoes) {
  OccupancyGrid map(kVoxel);
  map.Set({1, 0, 0}, 1.0F);
  const Track away = TrackOf({At(0.0, 0.05, 0.05), At(-2.0, 0.05, 0.05)});
  PathCheck check({.radius = 0.2});
  check.Restart(map, away, 0.0);
  Finish(check, map, away);
  EXPECT_FALSE(check.obstacle_W());
  map.Set({2, 0, 0}, 1.0F);
  const Track into = TrackOf({At(0.0, 0.05, 0.05), At(1.0, 0.05, 0.05)});
  check.Restart(map, into, 0.0);
  Finish(check, map, into);
  ASSERT_TRUE(check.obstacle_W());
  EXPECT_NEAR(check.obstacle_W()->x(), 0.25, 1e-9);
}

TEST(PathCheck, TheFloorOnWhichARobotDrivesIsNotInItsWay) {
  OccupancyGrid map(kVoxel);
  for (int x = -10; x < 60; ++x) {
    for (int y = -10; y < 10; ++y) map.Set({x, y, 0}, 2.0F);  // up to z = 0.1
  }
  const Track track = TrackOf({At(0.0, 0.0, 0.28), At(5.0, 0.0, 0.28)});
  const PathCheck::Body flies{.radius = 0.2, .height = 0.4};  // from z = 0.08
  PathCheck drives({.radius = 0.2, .height = 0.4, .drives = true});
  drives.Restart(map, track, 0.0);
  Finish(drives, map, track);
  EXPECT_FALSE(drives.obstacle_W());
  PathCheck scrapes(flies);
  scrapes.Restart(map, track, 0.0);
  Finish(scrapes, map, track);
  EXPECT_TRUE(scrapes.obstacle_W());
  map.Set({20, 0, 1}, 2.0F);
  drives.Restart(map, track, 0.0);
  Finish(drives, map, track);
  EXPECT_TRUE(drives.obstacle_W()) << "what stands on the floor is";
}

TEST(PathCheck, ALongPathOfALargeBodyIsCheckedInManySmallPieces) {
  OccupancyGrid map(0.05);
  for (int x = -20; x < 420; ++x) {
    for (int y = -20; y < 20; ++y) {
      for (int z = -20; z < 20; ++z) map.Set({x, y, z}, -2.0F);
    }
  }
  const Track track = TrackOf({At(0.0), At(20.0)});
  PathCheck check({.radius = 0.5});
  check.Restart(map, track, 0.0);
  int pieces = 0;
  for (double before = 0.0; check.clear_to() < track.length(); before = check.clear_to()) {
    check.Continue(map, track);
    ASSERT_GT(check.clear_to(), before);
    ++pieces;
  }
  // A sample looks at the 21^3 voxels of the body's box and up to 4^3 blocks.
  EXPECT_GE(pieces, 20.0 / 0.0125 * 20 * 20 * 20 / (PathCheck::kBudget + 9400.0));
  EXPECT_FALSE(check.obstacle_W());
}

}  // namespace
}  // namespace thalweg::controller
