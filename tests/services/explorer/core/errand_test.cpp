#include "services/explorer/core/errand.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/angles.h"
#include "tests/services/explorer/support/knowing.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

constexpr double kRange = 2.0;  // [m]
constexpr VoxelBox kRoom{{0, 0, 0}, {40, 30, 12}};

/// A room of 4 x 3 x 1.2 m with a wall across at x = 2 m that leaves a gap of 0.6 m at its end.
std::vector<VoxelChange> DividedRoom(int gap = 6) {
  std::vector<VoxelChange> changes = test::ClosedRoom(kRoom);
  test::Fill(changes, {{20, 0, 0}, {21, 30 - gap, 12}}, VoxelState::kOccupied);
  return changes;
}

class ErrandTest : public testing::Test {
 protected:
  const PlanningMap& map() const { return knowledge_.map(); }
  Result<ErrandPath> Find(const Errand& errand) const {
    return FindErrandPath(
        errand, T_WB_, knowledge_, finder_,
        {.robot_radius = 0.1, .exemption = 0.3, .wide_exemption = 0.3, .sensor_range = kRange});
  }
  Result<ErrandPath> GoTo(const Eigen::Vector3d& p_W) const {
    return Find({.kind = Errand::Kind::kGoTo, .p_W = p_W});
  }
  Result<ErrandPath> LookAt(const Eigen::Vector3d& p_W) const {
    return Find({.kind = Errand::Kind::kLookAt, .p_W = p_W});
  }
  bool Sees(const Eigen::Vector3d& from_W, const Eigen::Vector3d& p_W) const {
    const Eigen::Vector3d center_W = map().CenterOf(map().IndexOf(p_W));
    return knowledge_.views().CanSee(map(), from_W, center_W, kRange);
  }
  /// Whether the camera of a body with that orientation has a point in its image.
  bool Shows(const ErrandPath& found, const Eigen::Vector3d& p_W) const {
    const VoxelIndex voxel = map().IndexOf(p_W);
    return knowledge_.views().Shows(found.R_WB, {voxel, map().CenterOf(voxel) - found.path_W.back()});
  }

  /// How many voxels of a box are in sight and in the image at the end of the path.
  std::size_t ShownOf(const ErrandPath& found, const VoxelBox& box) const {
    std::size_t shown = 0;
    test::ForEachVoxel(box, [&](const VoxelIndex& i) {
      const Eigen::Vector3d p_W = map().CenterOf(i);
      if (Sees(found.path_W.back(), p_W) && Shows(found, p_W)) ++shown;
    });
    return shown;
  }

  Knowledge knowledge_ = test::Knowing(DividedRoom());
  GoalFinder finder_{kRange, 0.1};
  RigidTransform T_WB_ = test::At(0.55, 0.55, 0.55);
};

TEST_F(ErrandTest, AFreeWayIsTakenStraightAndEndsInItsDirection) {
  const auto found = GoTo({0.56, 1.53, 0.55});
  ASSERT_TRUE(found) << found.error();
  EXPECT_EQ(found->path_W.front(), T_WB_.translation());
  EXPECT_TRUE(found->path_W.back().isApprox(Eigen::Vector3d(0.55, 1.55, 0.55), 1e-9)) << "the voxel's center";
  EXPECT_NEAR(PathLength(found->path_W), 1.0, 1e-9);
  EXPECT_NEAR(YawOf(found->R_WB), 90.0 * kDegree, 1e-9);
  const auto turned =
      Find({.kind = Errand::Kind::kGoTo, .p_W = {0.55, 1.55, 0.55}, .yaw_W = -30.0 * kDegree});
  ASSERT_TRUE(turned);
  EXPECT_NEAR(YawOf(turned->R_WB), -30.0 * kDegree, 1e-9);
}

TEST_F(ErrandTest, RoundTheWallItTakesTheShortestPath) {
  const auto found = GoTo({3.55, 0.55, 0.55});
  ASSERT_TRUE(found) << found.error();
  PathSearch search;
  search.Flood(map(), {{map().IndexOf(T_WB_.translation()), 0}});
  const double length = search.Length(map().IndexOf({3.55, 0.55, 0.55}));
  EXPECT_GT(length, 4.5) << "by way of the gap";
  // Costs are truncated to hundredths: a diagonal step counts 1.41 voxels.
  EXPECT_NEAR(PathLength(found->path_W), length, 0.004 * length);
  for (const Eigen::Vector3d& p_W : found->path_W) EXPECT_TRUE(map().Traversable(map().IndexOf(p_W)));
}

TEST_F(ErrandTest, SaysWhyNobodyCanStandThere) {
  knowledge_.SetNoGo({{Eigen::Vector3d(3.0, 2.0, 0.0), Eigen::Vector3d(3.5, 2.5, 1.2)}});
  const auto error = [&](const Eigen::Vector3d& p_W) {
    const auto found = GoTo(p_W);
    return found ? "" : found.error();
  };
  EXPECT_EQ(error({2.05, 0.55, 0.55}), "the goal (2.05, 0.55, 0.55) lies in an obstacle");
  EXPECT_EQ(error({9.05, 0.55, 0.55}), "the goal (9.05, 0.55, 0.55) lies in space that is not known yet");
  EXPECT_EQ(error({3.25, 2.25, 0.55}), "the goal (3.25, 2.25, 0.55) lies in a no-go box");
  EXPECT_EQ(error({1.95, 0.55, 0.55}),
            "the goal (1.95, 0.55, 0.55) is free, but too near to an obstacle, a no-go box or unknown space "
            "for the robot's body");
  Knowledge::Options options = test::KnowingOptions();
  options.map.bounds.emplace(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(3, 3, 1.2));
  knowledge_ = test::Knowing(DividedRoom(), options);
  EXPECT_EQ(error({3.55, 0.55, 0.55}),
            "the goal (3.55, 0.55, 0.55) lies outside the bounds of the exploration");
}

TEST_F(ErrandTest, WhatIsInSightIsLookedAtFromHere) {
  const Eigen::Vector3d p_W(0.55, 1.85, 0.95);
  const auto found = LookAt(p_W);
  ASSERT_TRUE(found) << found.error();
  ASSERT_EQ(found->path_W.size(), 1U);
  EXPECT_EQ(found->path_W.front(), T_WB_.translation());
  const Eigen::Vector3d to_W = (p_W - T_WB_.translation()).normalized();
  EXPECT_TRUE(found->R_WB.col(0).isApprox(to_W, 1e-9)) << "the camera's axis points at it";
}

TEST_F(ErrandTest, WhatIsHiddenIsLookedAtFromAPlaceAboutAsNearToItAsAny) {
  const Eigen::Vector3d p_W(3.85, 0.15, 1.15);  // in a corner, where no body fits
  ASSERT_FALSE(Sees(T_WB_.translation(), p_W));
  const auto found = LookAt(p_W);
  ASSERT_TRUE(found) << found.error();
  const Eigen::Vector3d end_W = found->path_W.back();
  EXPECT_TRUE(Sees(end_W, p_W));
  EXPECT_TRUE(Shows(*found, p_W));
  PathSearch search;
  search.Flood(map(), {{map().IndexOf(T_WB_.translation()), 0}});
  EXPECT_TRUE(search.Reached(map().IndexOf(end_W)));
  double nearest = std::numeric_limits<double>::infinity();
  for (const VoxelIndex& i : test::TraversableVoxels(map())) {
    const Eigen::Vector3d q_W = map().CenterOf(i);
    if (search.Reached(i) && Sees(q_W, p_W)) nearest = std::min(nearest, (q_W - p_W).norm());
  }
  // Rays only sample the directions.
  EXPECT_LE((end_W - p_W).norm(), nearest + 0.25);
}

TEST_F(ErrandTest, TheMiddleOfAFrontierIsLookedAtFromWhereTheFrontierIsSeen) {
  std::vector<VoxelChange> changes = DividedRoom();
  test::Fill(changes, {{28, 10, 2}, {36, 18, 10}}, VoxelState::kUnknown);
  knowledge_ = test::Knowing(changes);
  const Eigen::Vector3d p_W(3.25, 1.45, 0.65);  // in the middle of what is unknown
  const auto found = LookAt(p_W);
  ASSERT_TRUE(found) << found.error();
  const Eigen::Vector3d end_W = found->path_W.back();
  EXPECT_FALSE(Sees(end_W, p_W));
  EXPECT_TRUE(Shows(*found, p_W));
  std::size_t seen = 0;
  test::ForEachVoxel({{28, 10, 2}, {36, 18, 10}}, [&](const VoxelIndex& i) {
    const Eigen::Vector3d q_W = map().CenterOf(i);
    if ((q_W - p_W).norm() <= 0.5 && Sees(end_W, q_W)) ++seen;
  });
  EXPECT_GT(seen, 0U);
  EXPECT_GT(ShownOf(*found, {{28, 10, 2}, {36, 18, 10}}), 0U) << "what is in sight is in the image";
  T_WB_ = test::At(end_W.x(), end_W.y(), end_W.z());
  const auto turned = LookAt(p_W);
  ASSERT_TRUE(turned) << turned.error();
  EXPECT_EQ(turned->path_W.size(), 1U) << "from there it need not go anywhere";
  EXPECT_GT(ShownOf(*turned, {{28, 10, 2}, {36, 18, 10}}), 0U);
}

TEST_F(ErrandTest, AFrontierOnTheOtherSideOfAWallIsNotLookedAtInstead) {
  // A pocket before the wall across, and a point in the closed room behind it.
  std::vector<VoxelChange> changes = DividedRoom(/*gap=*/0);
  test::Fill(changes, {{17, 4, 4}, {20, 7, 7}}, VoxelState::kUnknown);
  knowledge_ = test::Knowing(changes);
  EXPECT_TRUE(LookAt({1.85, 0.55, 0.55})) << "the pocket itself";
  EXPECT_FALSE(LookAt({2.25, 0.55, 0.55}));
}

TEST_F(ErrandTest, BehindAClosedWallNothingIsReachedOrSeen) {
  knowledge_ = test::Knowing(DividedRoom(/*gap=*/0));
  const auto went = GoTo({3.05, 0.55, 0.55});
  ASSERT_FALSE(went);
  EXPECT_EQ(went.error(), "no known path leads to (3.05, 0.55, 0.55)");
  const auto looked = LookAt({3.05, 0.55, 0.55});
  ASSERT_FALSE(looked);
  EXPECT_EQ(looked.error(), "no place that the robot can reach is known to see (3.05, 0.55, 0.55)");
}

}  // namespace
}  // namespace thalweg::explorer
