#include "services/explorer/core/errand_planner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "common/base/angles.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

using std::chrono_literals::operator""s;
using test::kStart;

constexpr VoxelBox kHall{{0, 0, 0}, {50, 30, 20}};

/// A hall of 5 x 3 x 2 m with a wall across at x = 3 m that leaves a gap of 0.8 m at its end.
std::vector<VoxelChange> DividedHall() {
  std::vector<VoxelChange> changes = test::ClosedRoom(kHall);
  test::Fill(changes, {{30, 0, 0}, {31, 22, 20}}, VoxelState::kOccupied);
  return changes;
}

Errand GoTo(const Eigen::Vector3d& p_W) {
  return {.kind = Errand::Kind::kGoTo, .p_W = p_W};
}

Errand LookAt(const Eigen::Vector3d& p_W) {
  return {.kind = Errand::Kind::kLookAt, .p_W = p_W};
}

/// An operator's robot that set out far from all walls.
class ErrandPlannerTest : public testing::Test {
 protected:
  ErrandPlannerTest() {
    options_.look_range = 2.0;
    options_.sensor_range = 2.0;
  }
  /// Makes a task with what the options are by now.
  Result<Task> Make(const Errand& errand, Time now = kStart) {
    Knowledge knowledge = Knowing();
    return MakeWith(knowledge, errand, now);
  }
  Knowledge Knowing() const {
    Knowledge knowledge(KnowledgeOptions(options_));
    knowledge.Update(changes_, {}, kStart);
    return knowledge;
  }
  Result<Task> MakeWith(Knowledge& knowledge, const Errand& errand, Time now = kStart) const {
    Mission mission(MissionOptions(options_));
    EXPECT_FALSE(mission.Spent(kStart));
    mission.FindPathsHome(knowledge.map(), kHome_W);
    const TaskMaker make(options_, knowledge, nullptr);
    return ErrandPlanner(options_).MakeTask(errand, T_WB_, now, make, mission, knowledge);
  }
  /// Why there is no task; empty if there is one.
  std::string Refusal(const Errand& errand, Time now = kStart) {
    const Result<Task> task = Make(errand, now);
    return task ? "" : task.error();
  }

  const Eigen::Vector3d kHome_W{0.55, 1.05, 1.05};
  ExplorerOptions options_ = test::GoingOptions();
  std::vector<VoxelChange> changes_ = DividedHall();
  RigidTransform T_WB_ = test::At(0.55, 1.05, 1.05);
};

TEST_F(ErrandPlannerTest, GoesStraightWhereNothingIsInTheWayAndShowsThePointItself) {
  const Eigen::Vector3d p_W(2.04, 1.66, 1.03);
  const Result<Task> task = Make(GoTo(p_W));
  ASSERT_TRUE(task) << task.error();
  EXPECT_EQ(task->plan.kind, Plan::Kind::kGo);
  EXPECT_EQ(task->plan.purpose, Purpose::kGoTo);
  EXPECT_EQ(task->plan.target_W, p_W);
  EXPECT_NEAR(task->plan.length, std::hypot(1.5, 0.6), 1e-9) << "to the middle of the voxel";
  EXPECT_EQ(task->plan.T_WBs.front().translation(), T_WB_.translation());
  EXPECT_LT((task->plan.T_WBs.back().translation() - Eigen::Vector3d(2.05, 1.65, 1.05)).norm(), 1e-9);
  EXPECT_FALSE(task->plan.ending);
  EXPECT_EQ(task->plan.frontiers, 0U);
  EXPECT_TRUE(task->target.empty()) << "nothing unknown is asked for";
}

TEST_F(ErrandPlannerTest, EndsWithTheHeadingThatWasAskedFor) {
  Errand errand = GoTo({2.05, 1.05, 1.05});
  const Result<Task> ahead = Make(errand);
  ASSERT_TRUE(ahead) << ahead.error();
  EXPECT_NEAR(YawOf(ahead->plan.T_WBs.back().linear()), 0.0, 1e-9) << "without one, the path's";
  errand.yaw_W = -120.0 * kDegree;
  const Result<Task> task = Make(errand);
  ASSERT_TRUE(task) << task.error();
  EXPECT_NEAR(YawOf(task->plan.T_WBs.back().linear()), -120.0 * kDegree, 1e-9);
}

TEST_F(ErrandPlannerTest, GoesRoundAWallOnAPathThatKeepsClear) {
  const Eigen::Vector3d p_W(4.55, 1.05, 1.05);
  const Result<Task> task = Make(GoTo(p_W));
  ASSERT_TRUE(task) << task.error();
  // The body keeps 0.15 m from the end of the wall, whose faces are at x = 3.0 m and 3.1 m and which ends at
  // y = 2.2 m.
  const auto by_way_of = [&](double y) {
    const Eigen::Vector3d before_W(3.0, y, 1.05);
    const Eigen::Vector3d behind_W(3.1, y, 1.05);
    return (before_W - kHome_W).norm() + (behind_W - before_W).norm() + (p_W - behind_W).norm();
  };
  EXPECT_GT(task->plan.length, by_way_of(2.35) - 0.02) << "no path that keeps clear is shorter";
  EXPECT_LT(task->plan.length, by_way_of(2.6)) << "there is no reason to go by way of the gap's middle";
  const PlanningMap map = Knowing().map();
  std::vector<Eigen::Vector3d> path_W;
  for (const RigidTransform& T_WB : task->plan.T_WBs) path_W.push_back(T_WB.translation());
  EXPECT_GE(test::SampledClearance(map, path_W, PlanningMap::Obstacles::kOccupiedAndUnknown, 0.3),
            options_.clearance() - 0.1 / 8 - 0.001);
}

TEST_F(ErrandPlannerTest, TurnsOnTheSpotToWhatIsInSight) {
  const Eigen::Vector3d p_W(1.55, 1.85, 1.35);
  const Result<Task> task = Make(LookAt(p_W));
  ASSERT_TRUE(task) << task.error();
  EXPECT_EQ(task->plan.kind, Plan::Kind::kLook);
  EXPECT_EQ(task->plan.purpose, Purpose::kLookAt);
  EXPECT_EQ(task->plan.target_W, p_W);
  EXPECT_EQ(task->plan.length, 0.0);
  ASSERT_EQ(task->plan.T_WBs.size(), 1U);
  EXPECT_EQ(task->plan.T_WBs[0].translation(), T_WB_.translation());
  const Eigen::Vector3d to_W = (p_W - T_WB_.translation()).normalized();
  EXPECT_LT((task->plan.T_WBs[0].linear().col(0) - to_W).norm(), 1e-9) << "the camera's axis points at it";
}

TEST_F(ErrandPlannerTest, GoesToWhereTheHiddenIsInSightAndInTheImage) {
  const Eigen::Vector3d p_W(3.25, 0.25, 0.25);  // behind the wall, in a corner where no body fits
  const Result<Task> task = Make(LookAt(p_W));
  ASSERT_TRUE(task) << task.error();
  EXPECT_EQ(task->plan.kind, Plan::Kind::kGo);
  EXPECT_EQ(task->plan.purpose, Purpose::kLookAt);
  EXPECT_EQ(task->plan.target_W, p_W);
  const RigidTransform& T_WB = task->plan.T_WBs.back();
  const Eigen::Vector3d to_W = p_W - T_WB.translation();
  EXPECT_GT(T_WB.translation().x(), 3.0);
  EXPECT_LE(to_W.norm(), options_.sensor_range);
  EXPECT_GT(T_WB.linear().col(0).dot(to_W.normalized()), std::cos(37.5 * kDegree))
      << "half of its 75 degrees";
}

TEST_F(ErrandPlannerTest, LooksIntoANicheFromAsFarAsTheCameraSees) {
  // A niche of 0.3 x 0.2 m and 0.6 m deep, behind the wall; no body fits in it.
  for (const VoxelChange& change : test::ClosedRoom({{40, -6, 9}, {43, 0, 11}})) {
    if (change.voxel.y < 0) changes_.push_back(change);
  }
  const Eigen::Vector3d p_W(4.15, -0.55, 0.95);
  const Result<Task> task = Make(LookAt(p_W));
  ASSERT_TRUE(task) << task.error();
  EXPECT_EQ(task->plan.kind, Plan::Kind::kGo);
  EXPECT_GT((task->plan.T_WBs.back().translation() - p_W).norm(), 0.55 + 0.15);
  options_.look_range = 0.5;
  EXPECT_EQ(Refusal(LookAt(p_W)), "no place that the robot can reach is known to see (4.15, -0.55, 0.95)");
}

TEST_F(ErrandPlannerTest, LeavesAPlaceTooNearToAWall) {
  T_WB_ = test::At(0.55, 0.05, 1.05);  // its body would reach into the wall
  options_.wide_exemption = 0.0;
  const Errand errand = GoTo({2.05, 1.05, 1.05});
  EXPECT_EQ(Refusal(errand), "");
  options_.exemption = 0.05;
  EXPECT_EQ(Refusal(errand), "no known path leads to (2.05, 1.05, 1.05)");
  options_.wide_exemption = 1.0;
  EXPECT_EQ(Refusal(errand), "") << "the wide one is tried, too";
}

TEST_F(ErrandPlannerTest, WhatCannotBeDoneIsRefusedWithItsReason) {
  EXPECT_EQ(Refusal(GoTo({3.05, 1.05, 1.05})), "the goal (3.05, 1.05, 1.05) lies in an obstacle");
  EXPECT_EQ(Refusal(GoTo({8.05, 1.05, 1.05})),
            "the goal (8.05, 1.05, 1.05) lies in space that is not known yet");
  EXPECT_EQ(Refusal(LookAt({8.05, 1.05, 1.05})),
            "no place that the robot can reach is known to see (8.05, 1.05, 1.05)");
  options_.no_go = {{Eigen::Vector3d(1.5, 0.5, 0.5), Eigen::Vector3d(2.5, 1.5, 1.5)}};
  EXPECT_EQ(Refusal(GoTo({2.05, 1.05, 1.05})), "the goal (2.05, 1.05, 1.05) lies in a no-go box");
  test::Fill(changes_, {{30, 22, 0}, {31, 30, 20}}, VoxelState::kOccupied);  // closes the gap
  EXPECT_EQ(Refusal(GoTo({4.55, 1.05, 1.05})), "no known path leads to (4.55, 1.05, 1.05)");
}

TEST_F(ErrandPlannerTest, ABudgetMustAllowThePathAndTheOneHome) {
  options_.return_home = true;
  options_.home_margin = 0.15;
  const Errand errand = GoTo({2.55, 1.05, 1.05});
  const double there = 2.0;
  const double home = 1.15 * there + HomePaths::Options{}.reserve;
  EXPECT_EQ(Refusal(errand), "") << "without a budget";
  options_.distance_budget = there + home + 0.05;
  EXPECT_EQ(Refusal(errand), "");
  options_.distance_budget = there + home - 0.05;
  EXPECT_EQ(Refusal(errand), "the rest of the distance budget does not allow it");
  options_.distance_budget = 0.0;
  options_.time_budget = 60s;
  const double half_turn = 180.0 * kDegree / options_.robot.max_turn_rate;            // [s]
  const double needed = (there + home) / options_.robot.max_speed + 2.0 * half_turn;  // [s]
  EXPECT_EQ(Refusal(errand, kStart + 60s - FromSeconds(needed + 0.1)), "");
  EXPECT_EQ(Refusal(errand, kStart + 60s - FromSeconds(needed - 0.1)),
            "the rest of the time budget does not allow it");
}

TEST_F(ErrandPlannerTest, ABudgetDoesNotForbidTheGoalOfARobotThatNeedNotReturn) {
  options_.distance_budget = 1.0;
  EXPECT_EQ(Refusal(GoTo({2.55, 1.05, 1.05})), "") << "it ends when it is spent";
}

TEST_F(ErrandPlannerTest, ATurnCostsNoneOfTheDistance) {
  options_.return_home = true;
  options_.distance_budget = 0.1;
  EXPECT_EQ(Refusal(LookAt({1.55, 1.85, 1.35})), "");
  EXPECT_EQ(Refusal(LookAt({3.25, 0.25, 0.25})), "the rest of the distance budget does not allow it");
}

TEST_F(ErrandPlannerTest, TheRobotStandsInFreeSpaceWhateverTheMapSays) {
  test::Fill(changes_, {{5, 10, 10}, {6, 11, 11}}, VoxelState::kUnknown);
  Knowledge knowledge = Knowing();
  const VoxelIndex here = knowledge.map().IndexOf(T_WB_.translation());
  ASSERT_EQ(knowledge.map().State(here), VoxelState::kUnknown);
  const Result<Task> task = MakeWith(knowledge, GoTo({2.05, 1.05, 1.05}));
  EXPECT_EQ(knowledge.map().State(here), VoxelState::kFree);
  ASSERT_TRUE(task) << task.error();
  EXPECT_NEAR(task->plan.length, 1.5, 1e-9);
}

TEST_F(ErrandPlannerTest, ARobotThatDrivesGoesToThePointInItsPlaneAndShowsTheOneThatWasClicked) {
  options_.robot.drives = true;
  options_.robot.height = 0.4;
  Knowledge knowledge = Knowing();
  T_WB_ = knowledge.InPlane(test::At(0.55, 1.05, 0.38));
  const Eigen::Vector3d p_W(2.05, 1.05, 1.45);
  const Result<Task> task = MakeWith(knowledge, GoTo(p_W));
  ASSERT_TRUE(task) << task.error();
  EXPECT_EQ(task->plan.target_W, p_W);
  for (const RigidTransform& T_WB : task->plan.T_WBs) EXPECT_NEAR(T_WB.translation().z(), 0.38, 1e-12);
  EXPECT_NEAR(task->plan.T_WBs.back().translation().x(), 2.05, 1e-9);
}

TEST_F(ErrandPlannerTest, ARobotThatTurnsOnlyInCurvesArrivesWithTheHeadingThatWasAskedForOrAny) {
  options_.robot.drives = true;
  options_.robot.height = 0.4;
  options_.robot.drive = Drive::kAckermann;
  options_.robot.min_turning_radius = 0.3;
  Knowledge knowledge = Knowing();
  T_WB_ = knowledge.InPlane(test::At(0.55, 1.05, 0.38));
  Errand errand = GoTo({2.05, 1.05, 0.38});
  const auto end_of = [&] {
    const Result<Task> task = MakeWith(knowledge, errand);
    return task ? task->plan.T_WBs.back() : RigidTransform::Identity();
  };
  EXPECT_NEAR(end_of().translation().x(), 2.05, 0.1);
  EXPECT_NEAR(AngleBetween(end_of(), T_WB_), 0.0, 0.05) << "straight ahead";
  errand.yaw_W = 3.0;
  EXPECT_NEAR(end_of().translation().x(), 2.05, 0.1);
  EXPECT_NEAR(YawOf(end_of().linear()), 3.0, 0.18);
}

}  // namespace
}  // namespace thalweg::explorer
