#include "services/surface/core/fused/volume_occupancy.h"

#include <gtest/gtest.h>

#include "common/voxel/map_agreement.h"
#include "services/surface/core/fused/fused_surface.h"
#include "tests/services/surface/core/fused/clouds.h"

namespace thalweg::surface {
namespace {

using Point = Eigen::Vector3d;
const PinholeCamera kCamera = PinholeCamera::FromFieldOfView(60, 45, 1.2);

PointCloud WallAhead(double distance, const RigidTransform& T_WC) {
  return test::CloudOf(kCamera, T_WC, [distance](const Point& o, const Point& d) {
    return test::ToPlane(Point(distance, 0, 0), Point(-1, 0, 0), o, d);
  });
}

TEST(VolumeOccupancy, AWallIsOccupiedWithFreeSpaceBeforeItAndNothingKnownBehind) {
  FusedSurface surface({.voxel_size = 0.02});
  const RigidTransform T_WC = test::LookingAt({0, 0, 0}, {1, 0, 0});
  surface.Fuse(WallAhead(2.0, T_WC), kCamera, T_WC);
  const OccupancyGrid grid = OccupancyOf(surface.volume());
  EXPECT_EQ(grid.voxel_size(), 0.08);
  const auto state = [&](double x) { return grid.State(grid.IndexOf({x, 0.1, 0.1})); };
  EXPECT_EQ(state(2.01), VoxelState::kOccupied);
  EXPECT_EQ(state(1.9), VoxelState::kFree);
  EXPECT_EQ(state(2.3), VoxelState::kUnknown);
  EXPECT_EQ(state(1.0), VoxelState::kUnknown) << "a volume knows nothing far from surfaces";
}

TEST(VolumeOccupancy, DistinguishesAnotherPlaceFromTheSame) {
  FusedSurface surface({.voxel_size = 0.02});
  const RigidTransform T_WC = test::LookingAt({0, 0, 0}, {1, 0, 0});
  surface.Fuse(WallAhead(2.0, T_WC), kCamera, T_WC);
  const OccupancyGrid grid = OccupancyOf(surface.volume());
  const MapAgreement same = Compare(grid, WallAhead(2.0, T_WC), T_WC, 4.0);
  EXPECT_TRUE(same.IsTelling());
  EXPECT_EQ(same.contradicting, 0U);
  EXPECT_FALSE(Compare(grid, WallAhead(2.15, T_WC), T_WC, 4.0).IsOfAnotherPlace()) << "drift";
  EXPECT_TRUE(Compare(grid, WallAhead(3.0, T_WC), T_WC, 4.0).IsOfAnotherPlace());
}

}  // namespace
}  // namespace thalweg::surface
