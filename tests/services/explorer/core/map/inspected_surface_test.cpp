#include "services/explorer/core/map/inspected_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/robot_model.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

/// A view along x from `p_W`.
ScanView LookingAlongX(const Eigen::Vector3d& p_W) {
  return {.T_WC = MakeTransform(BodyFromOptical(), p_W)};
}

class InspectedSurfaceTest : public testing::Test {
 protected:
  void Apply(const std::vector<VoxelChange>& changes) { surface_.Follow(map_, map_.Apply(changes)); }
  void Fill(const VoxelBox& box, VoxelState state) { Apply(test::BoxOf(box, state)); }

  PlanningMap map_{{.voxel_size = 0.1, .clearance = 0.15, .bounds = {}}};
  PinholeCamera camera_ = PinholeCamera::FromFieldOfView(100, 100, 90 * kDegree);
  InspectedSurface surface_{{.distance = 2.0, .max_angle = 60 * kDegree}, camera_, 0.5};
};

constexpr VoxelBox kWall{{30, -60, -10}, {31, 60, 10}};  // at x = 3 m, 12 m x 2 m
constexpr Facet kAhead{{30, 0, 0}, 1};                   // of its side toward smaller x

class Wall : public InspectedSurfaceTest {
 protected:
  Wall() {
    Fill({{0, -60, -10}, {30, 60, 10}}, VoxelState::kFree);
    Fill(kWall, VoxelState::kOccupied);
  }
};

TEST_F(Wall, IsInspectedFromNearOnly) {
  EXPECT_TRUE(surface_.Open(map_, kAhead));
  surface_.See(map_, LookingAlongX({1.0, 0.05, 0.05}));
  EXPECT_TRUE(surface_.Open(map_, kAhead)) << "2 m away, and the surface may lie at the voxel's far side";
  surface_.See(map_, LookingAlongX({1.15, 0.05, 0.05}));
  EXPECT_FALSE(surface_.Open(map_, kAhead));
}

TEST_F(Wall, IsInspectedSquarelyAndInTheImageOnly) {
  const Eigen::Vector3d eye_W(2.15, 0.05, 0.05);
  for (int y = 0; y < 40; ++y) {
    const double aside = 0.1 * y;
    const bool near = std::hypot(aside, 0.85) + 0.1 <= 2.0;
    const bool square = aside <= 0.85 * std::tan(60 * kDegree);
    EXPECT_EQ(surface_.InspectableFrom(map_, eye_W, {{30, y, 0}, 1}), near && square) << y;
  }
  surface_.See(map_, LookingAlongX(eye_W));
  for (int y = 0; y < 40; ++y) {
    const bool in_image = 0.1 * y < 0.85;  // half the field of view is 45 degrees
    EXPECT_EQ(surface_.Open(map_, {{30, y, 0}, 1}), !in_image) << y;
  }
}

TEST_F(Wall, ThatIsTakenAwayAndPutBackIsToBeInspectedAgain) {
  surface_.See(map_, LookingAlongX({2.0, 0.05, 0.05}));
  EXPECT_FALSE(surface_.Open(map_, kAhead));
  Fill(kWall, VoxelState::kFree);
  EXPECT_FALSE(surface_.Open(map_, kAhead)) << "there is nothing";
  Fill(kWall, VoxelState::kOccupied);
  EXPECT_TRUE(surface_.Open(map_, kAhead));
}

TEST_F(Wall, CountsOnlyWhereTheImageHasADepth) {
  ScanView dark = LookingAlongX({2.0, 0.05, 0.05});
  dark.measured = MeasuredShares{};  // nothing anywhere
  surface_.See(map_, dark);
  EXPECT_TRUE(surface_.Open(map_, kAhead));
  dark.measured->of_255.fill(255);
  surface_.See(map_, dark);
  EXPECT_FALSE(surface_.Open(map_, kAhead));
}

TEST_F(Wall, IsNotInspectedThroughAnObstacle) {
  Fill({{20, -60, -10}, {21, 0, 10}}, VoxelState::kOccupied);
  surface_.See(map_, LookingAlongX({1.55, -0.45, 0.05}));
  EXPECT_FALSE(surface_.Open(map_, {{20, -5, 0}, 1}));
  EXPECT_TRUE(surface_.Open(map_, {{30, -5, 0}, 1}));
}

TEST_F(Wall, AreasAddUpAndTwoViewsInVainAreEnough) {
  EXPECT_EQ(surface_.OpenFacets(map_).size(), 120U * 20U);
  EXPECT_NEAR(surface_.MeasureArea(map_).all, 24.0, 1e-9);
  EXPECT_EQ(surface_.MeasureArea(map_).inspected, 0.0);
  surface_.See(map_, LookingAlongX({2.0, 0.05, 0.05}));
  const double inspected = surface_.MeasureArea(map_).inspected;
  EXPECT_NEAR(inspected, 2.0 * 2.0, 0.3);  // the image at 1 m
  EXPECT_NEAR(0.01 * static_cast<double>(surface_.OpenFacets(map_).size()), 24.0 - inspected, 1e-9);
  const Facet aside{{30, 50, 0}, 1};
  surface_.CountTry(aside);
  EXPECT_TRUE(surface_.Open(map_, aside));
  surface_.CountTry(aside);
  EXPECT_FALSE(surface_.Open(map_, aside));
  EXPECT_NEAR(surface_.MeasureArea(map_).inspected, inspected, 1e-9) << "it was not inspected";
  surface_.Clear();
  surface_.Follow(map_, {});
  EXPECT_EQ(surface_.OpenFacets(map_).size(), 120U * 20U);
}

TEST_F(InspectedSurfaceTest, AStaircaseHasTheNormalOfItsSlope) {
  Fill({{-20, -20, -10}, {40, 40, 10}}, VoxelState::kFree);
  std::vector<VoxelChange> slope;  // x + y = 2 m
  for (int x = 0; x < 20; ++x) {
    const VoxelBox step{{x, 19 - x, -10}, {x + 1, 20 - x, 10}};
    test::Fill(slope, step, VoxelState::kOccupied);
  }
  Apply(slope);
  const Facet facet{{10, 9, 0}, 1};
  const auto eye_off_normal = [&](double degrees) {  // 1 m away, toward low x and y
    const double angle = (225 + degrees) * kDegree;
    return Eigen::Vector3d(CenterOf(map_, facet) + Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0));
  };
  EXPECT_TRUE(surface_.InspectableFrom(map_, eye_off_normal(0), facet));
  EXPECT_TRUE(surface_.InspectableFrom(map_, eye_off_normal(-40), facet));
  EXPECT_FALSE(surface_.InspectableFrom(map_, eye_off_normal(-70), facet)) << "though 25 off the step's own";
}

TEST_F(InspectedSurfaceTest, AThinBoardHasTwoSides) {
  Fill({{0, -20, -10}, {60, 20, 10}}, VoxelState::kFree);
  Fill({{30, -10, -10}, {31, 10, 10}}, VoxelState::kOccupied);
  const Facet behind{{30, 0, 0}, 0};
  surface_.See(map_, LookingAlongX({2.0, 0.05, 0.05}));
  EXPECT_FALSE(surface_.Open(map_, kAhead));
  EXPECT_TRUE(surface_.Open(map_, behind));
  EXPECT_TRUE(surface_.InspectableFrom(map_, {4.0, 0.05, 0.05}, behind));
  EXPECT_FALSE(surface_.InspectableFrom(map_, {2.0, 0.05, 0.05}, behind));
}

TEST(InspectionCriterion, ThatCannotBeMetIsRefused) {
  const PinholeCamera camera = DepthSensorModel{}.camera;
  EXPECT_THROW(InspectedSurface({.distance = 0.0}, camera, 0.5), std::invalid_argument);
  EXPECT_THROW(InspectedSurface({.max_angle = 90 * kDegree}, camera, 0.5), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::explorer
