#include "services/explorer/core/task.h"

#include <gtest/gtest.h>

#include "common/base/angles.h"
#include "common/geometry/polyline.h"
#include "tests/services/explorer/support/random_planning_map.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

constexpr double kLeast = 0.125;  // [m]
constexpr double kRadius = 0.1;   // [m]

/// A corridor 1.1 m wide along x, with a path on its axis that has a corner.
class TaskTest : public testing::Test {
 protected:
  TaskTest() {
    map_.Apply(test::BoxOf({{0, 0, 0}, {40, 11, 21}}, VoxelState::kFree));
    Follow();
  }
  void Follow() {
    FacedPath path;
    for (const Eigen::Vector3d& p_W : {Eigen::Vector3d(0.55, 0.55, 0.55), Eigen::Vector3d(3.05, 0.55, 0.55),
                                       Eigen::Vector3d(3.05, 0.55, 1.55)})
      path.T_WBs.push_back(MakeTransform(Eigen::Matrix3d::Identity(), p_W));
    path.narrow = {false, true, false};
    path.turn_first = true;
    task_.Follow(path, map_, kLeast);
  }
  void Occupy(const VoxelIndex& i) {
    map_.Apply(test::BoxOf({i, i + VoxelIndex{1, 1, 1}}, VoxelState::kOccupied));
  }

  PlanningMap map_{{.voxel_size = 0.1, .clearance = 0.15, .bounds = {}}};
  Task task_;
};

TEST_F(TaskTest, TakesAPathUp) {
  EXPECT_TRUE(task_.turn_first);
  EXPECT_EQ(task_.clearance.size(), 2U);
  EXPECT_NEAR(PathLength(task_.plan.T_WBs), 3.5, 1e-12);
}

TEST_F(TaskTest, AnObstacleAheadIsInTheWayAndOneBehindIsNot) {
  EXPECT_TRUE(task_.StillClear(map_, {0.55, 0.55, 0.55}, kLeast, kRadius));
  Occupy({15, 5, 6});
  EXPECT_FALSE(task_.StillClear(map_, {0.55, 0.55, 0.55}, kLeast, kRadius));
  EXPECT_TRUE(task_.StillClear(map_, {2.55, 0.55, 0.55}, kLeast, kRadius)) << "it is past it";
  Occupy({30, 6, 12});
  EXPECT_FALSE(task_.StillClear(map_, {2.55, 0.55, 0.55}, kLeast, kRadius)) << "round the corner";
}

TEST_F(TaskTest, WhatIsFartherThanTheLeastClearanceIsNotInTheWay) {
  Occupy({15, 7, 5});  // its near face is 0.15 m off the path
  EXPECT_TRUE(task_.StillClear(map_, {0.55, 0.55, 0.55}, kLeast, kRadius));
}

TEST_F(TaskTest, ARobotMustFaceANarrowPassageButNotAnOpenOne) {
  const auto turned = [](double degrees, const Eigen::Vector3d& p_W) {
    return MakeTransform(RotationFromYawPitch(degrees * kDegree, 0.0), p_W);
  };
  EXPECT_TRUE(task_.FacesNarrowPassage(turned(30.0, {1.55, 0.55, 0.55})));
  EXPECT_FALSE(task_.FacesNarrowPassage(turned(60.0, {1.55, 0.55, 0.55})));
  EXPECT_FALSE(task_.FacesNarrowPassage(turned(-60.0, {1.55, 0.55, 0.55})));
  EXPECT_TRUE(task_.FacesNarrowPassage(
      MakeTransform(Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitX()).toRotationMatrix(), {1.55, 0.55, 0.55})))
      << "rolled";
  EXPECT_TRUE(task_.FacesNarrowPassage(turned(180.0, {0.6, 0.55, 0.55}))) << "it may set out";
  EXPECT_TRUE(task_.FacesNarrowPassage(turned(180.0, {3.05, 0.55, 0.95}))) << "behind it";
}

TEST_F(TaskTest, WhatTheBodyTouchesFromTheBeginningIsNotInTheWayAndWhatAppearsBesideItIs) {
  const Eigen::Vector3d here_W(0.55, 0.55, 0.55);
  Occupy({5, 6, 5});  // 0.05 m beside the robot
  Follow();
  EXPECT_TRUE(task_.StillClear(map_, here_W, kLeast, kRadius));
  Occupy({9, 6, 5});  // as near as that to the path, but ahead
  EXPECT_FALSE(task_.StillClear(map_, here_W, kLeast, kRadius));
  EXPECT_TRUE(task_.StillClear(map_, here_W, kLeast, 0.04)) << "another body does not touch it";
}

TEST_F(TaskTest, APassageThatWasNarrowFromTheBeginningStaysOne) {
  constexpr double kThin = 0.04;
  Occupy({15, 6, 5});  // 0.05 m off
  Follow();
  EXPECT_TRUE(task_.StillClear(map_, {0.55, 0.55, 0.55}, kLeast, kThin));
  Occupy({20, 5, 5});
  EXPECT_FALSE(task_.StillClear(map_, {0.55, 0.55, 0.55}, kLeast, kThin)) << "narrower than it was";
}

TEST_F(TaskTest, CountsWhatIsKnownOfItsTarget) {
  task_.Aim({{50, 5, 5}, {51, 5, 5}, {52, 5, 5}}, map_);
  EXPECT_EQ(task_.doubtful_in_target(), 0U);
  EXPECT_EQ(task_.KnownOfTarget(map_), 0U);
  Occupy({51, 5, 5});
  EXPECT_EQ(task_.KnownOfTarget(map_), 1U);
}

TEST(Task, WhatWasDoubtfulIsKnownOnceItIsSureAndWhatWasUnknownInAnyCase) {
  PlanningMap map({.voxel_size = 0.1, .clearance = 0.15, .bounds = {}, .doubt = {.max_log_odds = 0.5}});
  const auto update = [&](const VoxelIndex& i, float log_odds) {
    const VoxelChange change{i, log_odds};
    map.Apply({&change, 1});
  };
  constexpr VoxelIndex kDoubtful{1, 0, 0};
  constexpr VoxelIndex kUnknown{2, 0, 0};
  update(kDoubtful, 0.4F);
  Task task;
  task.Aim({kDoubtful, kUnknown}, map);
  EXPECT_EQ(task.doubtful_in_target(), 1U);
  EXPECT_EQ(task.KnownOfTarget(map), 0U);
  update(kDoubtful, -0.4F);
  EXPECT_EQ(task.KnownOfTarget(map), 0U);
  update(kUnknown, -0.4F);
  EXPECT_EQ(task.KnownOfTarget(map), 1U);
  update(kDoubtful, -0.8F);
  EXPECT_EQ(task.KnownOfTarget(map), 2U);
  task.Aim({kUnknown}, map);
  EXPECT_EQ(task.doubtful_in_target(), 1U);
}

TEST_F(TaskTest, ARobotLeavesThePathNoSoonerThanItCan) {
  const RigidTransform T_WB = MakeTransform(RotationFromYawPitch(90.0 * kDegree, 0.0), {1.05, 0.57, 0.55});
  const auto departure = task_.DepartAhead(T_WB, {0.3, 0.2}, {1.2, 0.3}, {.max_turn_rate = 60.0 * kDegree});
  ASSERT_TRUE(departure);
  const std::vector<RigidTransform>& lead = departure->lead.T_WBs;
  ASSERT_EQ(lead.size(), 4U);
  EXPECT_EQ(departure->lead.narrow.size(), lead.size());
  EXPECT_TRUE(lead[0].translation().isApprox(Eigen::Vector3d(1.05, 0.55, 0.55), 1e-12)) << "on the path";
  ASSERT_EQ(departure->hears.pose, 1U);
  EXPECT_EQ(departure->hears.T_WB.translation(), lead[1].translation());
  EXPECT_NEAR(AngleBetween(departure->hears.T_WB, lead[1]), 78.0 * kDegree, 1e-6)
      << "of the 90 it has turned 12";
  EXPECT_TRUE(lead[1].translation().isApprox(Eigen::Vector3d(1.35, 0.55, 0.55), 1e-12))
      << "hears of the next";
  EXPECT_NEAR(departure->hears.left, 1.7 + 1.0, 1e-9) << "around the corner to the end";
  EXPECT_TRUE(lead[2].translation().isApprox(Eigen::Vector3d(2.55, 0.55, 0.55), 1e-12));
  EXPECT_NEAR((lead[3].translation() - lead[2].translation()).norm(), 0.1, 1e-9);
  EXPECT_EQ(departure->T_WB.translation(), lead[3].translation());
  EXPECT_NEAR(AngleBetween(departure->T_WB, lead[3]), 60.0 * kDegree, 1e-6) << "of the 90 it has turned 30";
}

TEST_F(TaskTest, WhatLeadsAheadFollowsCornersAndEndsWithThePath) {
  const auto round =
      task_.DepartAhead(test::At(2.55, 0.55, 0.55), {0.2, 0.0}, {0.8, 0.5}, {.max_turn_rate = 1.0});
  ASSERT_TRUE(round);
  EXPECT_NEAR(PathLength(round->lead.T_WBs), 1.1, 1e-9);
  EXPECT_TRUE(round->T_WB.translation().isApprox(Eigen::Vector3d(3.05, 0.55, 1.15), 1e-9));
  const auto end =
      task_.DepartAhead(test::At(2.55, 0.55, 0.55), {4.0, 0.0}, {5.0, 0.5}, {.max_turn_rate = 1.0});
  ASSERT_TRUE(end);
  EXPECT_TRUE(end->T_WB.translation().isApprox(Eigen::Vector3d(3.05, 0.55, 1.55), 1e-9));
  EXPECT_EQ(end->hears.pose + 1, end->lead.T_WBs.size()) << "it stands at the end before it hears";
  EXPECT_NEAR(end->hears.left, 0.0, 1e-9);
  EXPECT_FALSE(task_.DepartAhead(test::At(2.05, 0.95, 0.55), {0.0, 0.0}, {0.5, 0.5}, {.max_turn_rate = 1.0}))
      << "beside the path";
  EXPECT_FALSE(task_.DepartAhead(test::At(3.05, 0.55, 1.55), {0.0, 0.0}, {0.5, 0.5}, {.max_turn_rate = 1.0}))
      << "at its end";
}

TEST_F(TaskTest, WhatIsPrependedBelongsToThePath) {
  const FacedPath lead{.T_WBs = {test::At(0.35, 0.55, 0.55)}, .narrow = {true}};
  task_.Prepend(lead, map_, kLeast);
  EXPECT_NEAR(PathLength(task_.plan.T_WBs), 3.7, 1e-12);
  EXPECT_EQ(task_.clearance.size(), 3U);
  EXPECT_EQ(task_.narrow, (std::vector<bool>{true, false, true, false}));
}

}  // namespace
}  // namespace thalweg::explorer
