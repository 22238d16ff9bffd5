#include "services/surface/core/fused/remembered_place.h"

#include <gtest/gtest.h>

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

class RememberedPlaceTest : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(VoxelSizes, RememberedPlaceTest, testing::Values(0.005, 0.02, 0.05));

TEST_P(RememberedPlaceTest, DistinguishesAnotherPlaceFromTheSame) {
  FusedSurface surface({.voxel_size = GetParam()});
  const RigidTransform T_WC = test::LookingAt({0, 0, 0}, {1, 0, 0});
  surface.Fuse(WallAhead(2.0, T_WC), kCamera, T_WC);
  const RememberedPlace place(surface.volume());
  const MapAgreement same = place.Compare(WallAhead(2.0, T_WC), T_WC, 4.0);
  EXPECT_TRUE(same.IsTelling());
  EXPECT_EQ(same.contradicting, 0U);
  const MapAgreement drifted = place.Compare(WallAhead(2.2, T_WC), T_WC, 4.0);
  EXPECT_GT(drifted.agreeing, same.agreeing * 9 / 10);
  EXPECT_LT(drifted.contradicting, same.agreeing / 100);
  EXPECT_TRUE(place.Compare(WallAhead(3.0, T_WC), T_WC, 4.0).IsOfAnotherPlace());
  EXPECT_TRUE(place.Compare(WallAhead(9.0, T_WC), T_WC, 4.0).IsOfAnotherPlace()) << "beyond the range";
  EXPECT_EQ(place.Compare(WallAhead(3.0, T_WC), T_WC, 1.5).known(), 0U) << "up to where nothing is known";
}

TEST(RememberedPlace, IsNotContradictedByWhatPassesAnEdgeThatWasSeenFromOneSide) {
  const Eigen::AlignedBox3d box(Point(2.0, -0.5, -0.5), Point(2.4, 0.5, 0.5));
  const auto see = [&](const RigidTransform& T_WC) {
    return test::CloudOf(kCamera, T_WC, [&](const Point& o, const Point& d) {
      return std::min(test::ToBox(box, o, d), test::ToPlane(Point(0, 3, 0), Point(0, -1, 0), o, d));
    });
  };
  FusedSurface surface({.voxel_size = 0.02});
  const RigidTransform before = test::LookingAt({0, 0, 0}, {1, 0, 0});
  surface.Fuse(see(before), kCamera, before);
  const RememberedPlace place(surface.volume());
  for (const double x : {1.6, 1.9, 2.0, 2.2}) {
    const RigidTransform beside = test::LookingAt({x, -2, 0}, {x, 0, 0});
    const MapAgreement agreement = place.Compare(see(beside), beside, 8.0);
    EXPECT_LE(agreement.contradicting, 0.02 * 60 * 45) << "from x = " << x;
    EXPECT_FALSE(agreement.IsOfAnotherPlace());
  }
  // The box is gone.
  const auto without = test::CloudOf(kCamera, before, [](const Point& o, const Point& d) {
    return test::ToPlane(Point(5, 0, 0), Point(-1, 0, 0), o, d);
  });
  EXPECT_TRUE(place.Compare(without, before, 8.0).IsOfAnotherPlace());
}

}  // namespace
}  // namespace thalweg::surface
