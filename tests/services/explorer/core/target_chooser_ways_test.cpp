#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "services/explorer/core/aftermath.h"
#include "services/explorer/core/target_chooser.h"
#include "tests/services/explorer/support/choosing_robot.h"

/// Ways that are too narrow for paths from voxel to voxel, or shut.
namespace thalweg::explorer {
namespace {

using std::chrono_literals::operator""s;
using test::ChoosingRobot;
using test::kStart;
using test::TargetChooserTest;
using testing::IsEmpty;
using testing::SizeIs;

/// A robot of 0.1 m radius that keeps 0.2 m, in the long room with a wall across it that has a square hole.
class BeforeAHole : public TargetChooserTest {
 protected:
  BeforeAHole() {
    options_.robot.radius = 0.1;
    options_.safety_margin = 0.1;
  }
  static std::vector<VoxelChange> RoomWithAHole(int edge) {
    std::vector<VoxelChange> changes = test::LongRoom();
    test::Fill(changes, {{40, 0, 0}, {41, 12, 12}}, VoxelState::kOccupied);
    test::Fill(changes, {{40, 4, 3}, {41, 4 + edge, 3 + edge}}, VoxelState::kFree);
    return changes;
  }
  Task Choose(int edge) const { return ChoosingRobot(options_, RoomWithAHole(edge)).Choose(); }
};

TEST_F(BeforeAHole, ItGoesThroughOneThatIsWideEnoughInItsMiddleBeforeTheEnd) {
  const Task task = Choose(4);
  ASSERT_EQ(task.plan.purpose, Purpose::kSeeFrontier);
  EXPECT_GT(task.plan.T_WBs.back().translation().x(), 4.3) << "beyond the wall";
  EXPECT_FALSE(task.target.empty());
  for (const VoxelIndex& i : task.target) EXPECT_EQ(i.x, 60);
}

TEST_F(BeforeAHole, WhatItGoesToSeeIsNoLongerOutOfSightSoThatAVisitInVainIsRemembered) {
  ChoosingRobot robot(options_, RoomWithAHole(4));
  const Task task = robot.Choose();
  ASSERT_FALSE(task.target.empty());
  RememberArrival(task, robot.knowledge, kStart);
  for (const VoxelIndex& i : task.target)
    EXPECT_EQ(robot.knowledge.memory().set_aside()[i], static_cast<std::uint8_t>(AsideReason::kVisited));
}

TEST_F(BeforeAHole, ItNamesOneThatOnlyTheBodyWithoutItsMarginFits) {
  const Task task = Choose(3);
  ASSERT_EQ(test::EndOf(task.plan), Outcome::kTooMuchUnknown);
  ASSERT_THAT(task.plan.ending->tight_ways, SizeIs(1));
  EXPECT_NEAR(task.plan.ending->tight_ways[0].area, 1.44, 1e-9);
}

TEST_F(BeforeAHole, ItIsNotShutInOnceItHasGoneThrough) {
  options_.max_missed_share = 1.0;
  ChoosingRobot robot(options_, RoomWithAHole(4));
  const Task task = robot.Choose();
  ASSERT_EQ(task.plan.purpose, Purpose::kSeeFrontier);
  robot.T_WB = task.plan.T_WBs.back();
  robot.knowledge.Update(test::FarWall(), {}, kStart);
  EXPECT_EQ(test::EndOf(robot.Choose().plan), Outcome::kComplete)
      << "with less than half of the room in reach";
}

TEST_F(BeforeAHole, NorWhenItsProcessIsRestartedBeyondOrItsMapReplaced) {
  options_.max_missed_share = 1.0;
  ChoosingRobot before(options_, RoomWithAHole(4));
  const Task task = before.Choose();
  ASSERT_TRUE(before.chooser.gone_tight_way());
  ChoosingRobot robot(options_, RoomWithAHole(4), task.plan.T_WBs.back());
  robot.knowledge.Update(test::FarWall(), {}, kStart);
  EXPECT_EQ(test::EndOf(robot.Choose().plan), Outcome::kNothingReachable);
  robot.chooser.RestoreGoneTightWay(true);
  robot.chooser.Reset(robot.knowledge);
  EXPECT_EQ(test::EndOf(robot.Choose().plan), Outcome::kComplete);
}

TEST_F(BeforeAHole, ItSaysNothingOfOneThatTheBodyDoesNotFit) {
  const Task task = Choose(1);
  ASSERT_TRUE(task.plan.ending);
  EXPECT_THAT(task.plan.ending->tight_ways, IsEmpty());
}

TEST_F(BeforeAHole, ItStaysWhereItsPathHomeIsKnownOrTheRuleIsOff) {
  options_.return_home = true;
  EXPECT_EQ(test::EndOf(Choose(4).plan), Outcome::kTooMuchUnknown);
  options_.return_home = false;
  options_.loop.go_tight_ways = false;
  const Task task = Choose(4);
  ASSERT_EQ(test::EndOf(task.plan), Outcome::kTooMuchUnknown);
  EXPECT_THAT(task.plan.ending->tight_ways, SizeIs(1));
}

/// A robot that has begun to explore the long room, when a door is shut across it.
class BeforeADoor : public TargetChooserTest {
 protected:
  BeforeADoor() { EXPECT_EQ(robot_.Choose(now_).plan.purpose, Purpose::kSeeFrontier); }
  void Door(VoxelState state) {
    robot_.knowledge.Update(test::BoxOf({{30, 0, 0}, {31, 12, 12}}, state), {}, now_);
  }
  /// Chooses until the robot has carried out what leads it before the door.
  Task Choose() {
    Task task = robot_.Choose(now_);
    if (!task.plan.ending) robot_.T_WB = task.plan.T_WBs.back();
    return task;
  }

  Time now_ = kStart;
  ChoosingRobot robot_{options_, test::LongRoom()};
};

TEST_F(BeforeADoor, ItGoesThereAndWatchesItUntilItIsOpenAgain) {
  Door(VoxelState::kOccupied);
  const Task goes = Choose();
  ASSERT_EQ(goes.plan.purpose, Purpose::kWatchShutWay);
  EXPECT_EQ(goes.plan.kind, Plan::Kind::kGo);
  ASSERT_TRUE(goes.plan.target_W);
  EXPECT_NEAR(goes.plan.target_W->x(), 3.05, 1e-9);
  for (int second = 0; second < 20; ++second) {
    now_ += 1s;
    const Task watches = Choose();
    ASSERT_EQ(watches.plan.purpose, Purpose::kWatchShutWay);
    EXPECT_EQ(watches.plan.kind, Plan::Kind::kLook);
    EXPECT_GT(robot_.T_WB.linear().col(0).x(), 0.7) << "it faces the door";
  }
  Door(VoxelState::kFree);
  EXPECT_EQ(Choose().plan.purpose, Purpose::kSeeFrontier);
}

TEST_F(BeforeADoor, ItEndsWithoutWhatIsBehindOnceItHasWaitedForSoLong) {
  Door(VoxelState::kOccupied);
  Choose();
  Task task;
  int seconds = 0;
  for (; !task.plan.ending && seconds < 100; ++seconds) {
    task = Choose();
    now_ += 1s;
  }
  EXPECT_NEAR(seconds, 32, 2);
  ASSERT_TRUE(task.plan.ending);
  EXPECT_GT(task.plan.ending->shut_area, 1.0) << "of the far wall's 1.44 m2";
  ASSERT_THAT(task.plan.ending->shut_ways_W, SizeIs(1));
  EXPECT_NEAR(task.plan.ending->shut_ways_W[0].x(), 3.05, 1e-9);
}

TEST_F(BeforeADoor, ItEndsAfterItHasTwiceNotGotThere) {
  Door(VoxelState::kOccupied);
  for (int time = 0; time < 2; ++time) {
    const Task goes = robot_.Choose(now_);
    ASSERT_EQ(goes.plan.purpose, Purpose::kWatchShutWay);
    robot_.chooser.DidNotGetThere(goes, robot_.knowledge.map());
  }
  EXPECT_TRUE(robot_.Choose(now_).plan.ending);
}

TEST_F(BeforeADoor, WhatIsBehindCountsAsMissed) {
  for (const bool much : {false, true}) {
    options_.loop.wait_at_shut_ways = true;
    options_.max_missed_share = much ? 0.01 : 0.5;
    ChoosingRobot robot(options_, test::LongRoom());
    robot.Choose(now_);
    robot.knowledge.Update(test::BoxOf({{30, 0, 0}, {31, 12, 12}}, VoxelState::kOccupied), {}, now_);
    Task task;
    Time now = now_;
    for (int second = 0; !task.plan.ending && second < 100; ++second) {
      task = robot.Choose(now);
      if (!task.plan.ending) robot.T_WB = task.plan.T_WBs.back();
      now += 1s;
    }
    EXPECT_EQ(test::EndOf(task.plan), much ? Outcome::kTooMuchUnknown : Outcome::kComplete);
  }
}

TEST_F(BeforeADoor, WithTheRuleOffItEndsAtOnceAndSaysNothing) {
  options_.loop.wait_at_shut_ways = false;
  ChoosingRobot robot(options_, test::LongRoom());
  robot.Choose(now_);
  robot.knowledge.Update(test::BoxOf({{30, 0, 0}, {31, 12, 12}}, VoxelState::kOccupied), {}, now_);
  const Task task = robot.Choose(now_);
  ASSERT_TRUE(task.plan.ending);
  EXPECT_EQ(task.plan.ending->shut_area, 0.0);
}

}  // namespace
}  // namespace thalweg::explorer
