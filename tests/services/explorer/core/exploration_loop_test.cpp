#include "services/explorer/core/exploration_loop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "services/mapper/core/occupancy_map.h"
#include "tests/services/explorer/support/rooms.h"
#include "tests/support/analytic_room.h"

namespace thalweg::explorer {
namespace {

using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;
using test::kHere;

MapNews WholeMap(std::vector<VoxelChange> changes, double voxel_size = 0.1) {
  MapNews news;
  news.replaced = true;
  news.voxel_size = voxel_size;
  news.changes = std::move(changes);
  return news;
}

/// A controller and a mapper that report what the test wants.
class ExplorationLoopTest : public testing::Test {
 protected:
  void Give(const MapNews& news) { EXPECT_FALSE(loop_.OnMap(news, now_)); }
  void Begin() {
    Give(WholeMap(test::LongRoom()));
    loop_.OnPose(kHere);
    ASSERT_TRUE(loop_.Think(now_));
    ASSERT_EQ(loop_.state(), LoopState::kMoving);
  }
  void Report(MotionNews news) {
    news.stamp = now_;
    loop_.OnMotion(news, now_);
  }
  void SendScan(std::vector<VoxelChange> changes, Time stamp) {
    MapNews news;
    news.voxel_size = 0.1;
    news.changes = std::move(changes);
    news.scans = {{.T_WC = kHere * RobotModel{}.T_BC}};
    news.stamp = stamp;
    Give(news);
  }
  Time id() const { return loop_.order()->id; }
  /// Whether plans were interrupted that many times, and only for that reason.
  void ExpectInterrupted(Interruption why, std::size_t times = 1) const {
    const std::map<Interruption, std::size_t> expected = {{why, times}};
    EXPECT_EQ(loop_.interruptions(), expected);
    EXPECT_EQ(loop_.last_interruption(), why);
  }
  void BlockThePath() { SendScan(test::ObstacleAt(test::PointAlong(loop_.order()->T_WBs, 0.5)), now_); }

  Time now_{100s};
  ExplorationLoop loop_{test::GoingOptions()};
};

TEST_F(ExplorationLoopTest, PlansOnlyWhenTheRobotsPlaceIsKnown) {
  EXPECT_FALSE(loop_.Think(now_));
  loop_.OnPose(kHere);
  EXPECT_FALSE(loop_.Think(now_));
  loop_.OnPose(test::At(-3.0, 0.0, 0.0));
  Give(WholeMap(test::LongRoom()));
  EXPECT_FALSE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kWaiting);
  EXPECT_FALSE(loop_.order());
  loop_.OnPose(kHere);
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kMoving);
  ASSERT_TRUE(loop_.order());
  EXPECT_FALSE(loop_.order()->T_WBs.empty());
  EXPECT_FALSE(loop_.Think(now_)) << "nothing is due";
}

TEST_F(ExplorationLoopTest, UpdatesBeforeTheFirstWholeMapAreOfNoUse) {
  loop_.OnPose(kHere);
  SendScan(test::LongRoom(), now_);
  EXPECT_FALSE(loop_.Think(now_));
}

TEST_F(ExplorationLoopTest, AfterTheArrivalItWaitsForAScanFromThere) {
  Begin();
  const Time first = id();
  now_ += 10s;
  Report({.path_id = first, .done = true, .stopped = false, .standing = true, .stamp = {}});
  EXPECT_FALSE(loop_.Think(now_));
  SendScan({}, now_ - 1ms);
  EXPECT_FALSE(loop_.Think(now_)) << "a scan from before";
  SendScan({}, now_);
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_GT(id(), first);
  EXPECT_EQ(loop_.explorer().status().plans, 2U);
}

TEST_F(ExplorationLoopTest, BeforeAWayThatWasShutItLooksOnceASecond) {
  Begin();
  SendScan(test::BoxOf({{30, 0, 0}, {31, 12, 12}}, VoxelState::kOccupied), now_);  // across the room
  EXPECT_TRUE(loop_.Think(now_)) << "the path is blocked";
  Report({.path_id = id(), .stopped = true, .standing = true, .stamp = {}});
  EXPECT_TRUE(loop_.Think(now_));
  ASSERT_EQ(loop_.plan().purpose, Purpose::kWatchShutWay);
  const auto arrive = [&] {
    loop_.OnPose(loop_.order()->T_WBs.back());
    now_ += 1s;
    Report({.path_id = id(), .done = true, .standing = true, .stamp = {}});
  };
  arrive();
  SendScan({}, now_);
  EXPECT_TRUE(loop_.Think(now_)) << "it is there, and begins to watch";
  for (int second = 0; second < 5; ++second) {
    ASSERT_EQ(loop_.plan().purpose, Purpose::kWatchShutWay);
    arrive();
    now_ += 900ms;
    SendScan({}, now_);
    EXPECT_FALSE(loop_.Think(now_));
    now_ += 100ms;
    SendScan({}, now_);
    EXPECT_TRUE(loop_.Think(now_));
  }
}

TEST_F(ExplorationLoopTest, AReportOfAnotherPathIsIgnored) {
  Begin();
  now_ += 10s;
  Report({.path_id = id() - 1s, .done = true, .stopped = false, .standing = true, .stamp = {}});
  SendScan({}, now_);
  EXPECT_FALSE(loop_.Think(now_));
  EXPECT_EQ(loop_.explorer().status().plans, 1U);
}

TEST_F(ExplorationLoopTest, ARobotThatWasLostGetsAnotherPlanOnceItIsFoundAndNotForEverTheSame) {
  Begin();
  std::size_t plans = 1;
  for (int time = 0; time < 20 && loop_.state() == LoopState::kMoving; ++time) {
    const Time first = id();
    loop_.OnTracking(true, now_);
    for (int second = 0; second < 10; ++second) {
      now_ += 1s;
      Report({.path_id = first, .done = false, .stopped = true, .standing = true, .stamp = {}});
      EXPECT_FALSE(loop_.Think(now_)) << "lost: there is nothing to plan from";
    }
    loop_.OnTracking(false, now_);
    EXPECT_TRUE(loop_.Think(now_));
    EXPECT_TRUE(loop_.order()->T_WBs.empty()) << "stops first";
    now_ += 1s;
    Report({.path_id = id(), .done = false, .stopped = true, .standing = true, .stamp = {}});
    EXPECT_TRUE(loop_.Think(now_));
    EXPECT_EQ(loop_.explorer().status().plans, ++plans);
  }
  EXPECT_EQ(loop_.state(), LoopState::kDone) << "all that it can go for is set aside";
  ExpectInterrupted(Interruption::kLost, plans - 1);
  const auto aside = loop_.explorer().status().set_aside;
  EXPECT_TRUE(std::any_of(aside.begin(), aside.end(),
                          [](const auto& count) { return count.reason == AsideReason::kLostThere; }));
}

TEST_F(ExplorationLoopTest, AnUnsafePathStopsTheRobotAndANewOneComesOnlyOnceItStands) {
  Begin();
  const Time first = id();
  now_ += 1s;
  BlockThePath();
  EXPECT_TRUE(loop_.Think(now_));
  const Time stop = id();
  EXPECT_GT(stop, first);
  EXPECT_TRUE(loop_.order()->T_WBs.empty());
  EXPECT_EQ(loop_.replans(), 1U);
  ExpectInterrupted(Interruption::kPathBlocked);
  EXPECT_EQ(loop_.state(), LoopState::kPlanning);
  Report({.path_id = first, .done = false, .stopped = true, .standing = true, .stamp = {}});
  EXPECT_FALSE(loop_.Think(now_)) << "it stands, but has not heard of the stop";
  Report({.path_id = stop, .done = false, .stopped = true, .standing = false, .stamp = {}});
  EXPECT_FALSE(loop_.Think(now_)) << "still moving";
  now_ += 1s;
  Report({.path_id = stop, .done = false, .stopped = true, .standing = true, .stamp = {}});
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_GT(id(), stop);
  EXPECT_FALSE(loop_.order()->T_WBs.empty());
  EXPECT_EQ(loop_.state(), LoopState::kMoving);
}

/// A robot that minimizes time, and flies along its path.
class LoopInFlightTest : public ExplorationLoopTest {
 protected:
  LoopInFlightTest() {
    Explorer::Options options = test::GoingOptions();
    options.minimize = Minimize::kTime;
    loop_ = ExplorationLoop(options);
  }
  /// Lets it fly at its greatest speed, that far along the path.
  void FlyTo(double share) {
    now_ += 1s;
    here_W_ = test::PointAlong(loop_.order()->T_WBs, share);
    loop_.OnPose(MakeTransform(kHere.linear(), here_W_));
    Report({.path_id = id(), .speed = RobotModel{}.max_speed, .stamp = {}});
  }
  /// Expects that its path begins with as much of the one before as it flies in that time.
  void ExpectGoingOnFor(double seconds, const std::vector<RigidTransform>& before) const {
    const std::vector<RigidTransform>& after = loop_.order()->T_WBs;
    const double commits = RobotModel{}.max_speed * seconds;
    EXPECT_TRUE(after.front().translation().isApprox(here_W_, 1e-9));
    const Eigen::Vector3d ahead_W = (test::PointAlong(before, 0.2) - here_W_).normalized();
    const double whole = PathLength(after);
    ASSERT_GT(whole, commits);
    const Eigen::Vector3d leaves_W = test::PointAlong(after, commits / whole);
    EXPECT_TRUE(leaves_W.isApprox(here_W_ + commits * ahead_W, 1e-6));
    const double more = commits + 0.1;
    ASSERT_GT(whole, more);
    const Eigen::Vector3d beyond_W = test::PointAlong(after, more / whole);
    EXPECT_GT((beyond_W - (here_W_ + more * ahead_W)).norm(), 1e-3) << "and then turns off";
  }

  Eigen::Vector3d here_W_ = kHere.translation();
};

TEST_F(LoopInFlightTest, AnObstacleFarAheadChangesThePathAndDoesNotStopTheRobot) {
  Begin();
  FlyTo(0.1);
  const Time first = id();
  const std::vector<RigidTransform> before = loop_.order()->T_WBs;
  SendScan(test::ObstacleAt(test::PointAlong(before, 0.6)), now_);
  EXPECT_TRUE(loop_.Think(now_));
  ExpectInterrupted(Interruption::kPathBlocked);
  EXPECT_GT(id(), first);
  const std::vector<RigidTransform>& after = loop_.order()->T_WBs;
  ASSERT_GT(after.size(), 2U);
  EXPECT_EQ(loop_.state(), LoopState::kMoving);
  ExpectGoingOnFor(Explorer::Options{}.decision_time, before);
}

TEST_F(LoopInFlightTest, BeforeItDecidesItsPathEndsWhereItCanStopBeforeTheObstacle) {
  Begin();
  FlyTo(0.1);
  const Time first = id();
  const std::vector<RigidTransform> before = loop_.order()->T_WBs;
  SendScan(test::ObstacleAt(test::PointAlong(before, 0.6)), now_);
  const Time shortened = id();
  EXPECT_GT(shortened, first);
  const std::vector<RigidTransform> left = loop_.order()->T_WBs;
  ASSERT_GE(left.size(), 2U);
  const RobotModel robot;
  const double brakes = 0.5 * robot.max_speed * robot.max_speed / robot.max_acceleration;
  EXPECT_GT(PathLength(left), robot.max_speed * Explorer::Options{}.decision_time + brakes - 1e-9);
  EXPECT_LT(PathLength(left), 0.5 * PathLength(before)) << "the obstacle is there";

  // A decision that takes longer than that finds the robot at its end, where it has not arrived anywhere.
  loop_.OnPose(left.back());
  Report({.path_id = shortened, .done = true, .standing = true, .stamp = {}});
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kMoving);
  EXPECT_TRUE(loop_.order()->T_WBs.front().isApprox(left.back(), 1e-9));
  EXPECT_GT(loop_.order()->T_WBs.size(), 1U);
}

TEST_F(LoopInFlightTest, OneThatStandsBeforeAnObstacleStaysUntilItHasDecided) {
  Begin();
  SendScan(test::ObstacleAt(test::PointAlong(loop_.order()->T_WBs, 0.6)), now_);
  EXPECT_TRUE(loop_.order()->T_WBs.empty());
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_FALSE(loop_.order()->T_WBs.empty());
}

TEST_F(LoopInFlightTest, ADecisionThatIsExpectedToTakeLongLeavesThePathLater) {
  Begin();
  FlyTo(0.1);
  const std::vector<RigidTransform> before = loop_.order()->T_WBs;
  loop_.NoteDecisionTime(0.35);
  SendScan(test::ObstacleAt(test::PointAlong(before, 0.8)), now_);
  EXPECT_TRUE(loop_.Think(now_));
  ExpectGoingOnFor(0.5, before);
}

TEST_F(LoopInFlightTest, ADecisionThatTookLongIsForgottenAfterSomeThatDidNot) {
  Begin();
  FlyTo(0.1);
  const std::vector<RigidTransform> before = loop_.order()->T_WBs;
  loop_.NoteDecisionTime(0.35);
  for (int n = 0; n < 20; ++n) loop_.NoteDecisionTime(0.01);
  SendScan(test::ObstacleAt(test::PointAlong(before, 0.8)), now_);
  EXPECT_TRUE(loop_.Think(now_));
  ExpectGoingOnFor(Explorer::Options{}.decision_time, before);
}

TEST_F(LoopInFlightTest, AnObstacleThatIsNearerThanItBrakesStopsIt) {
  Begin();
  FlyTo(0.1);
  const Eigen::Vector3d ahead_W = (test::PointAlong(loop_.order()->T_WBs, 0.2) - here_W_).normalized();
  SendScan(test::ObstacleAt(here_W_ + 0.2 * ahead_W), now_);
  EXPECT_TRUE(loop_.Think(now_));
  ExpectInterrupted(Interruption::kPathBlocked);
  EXPECT_TRUE(loop_.order()->T_WBs.empty());
}

TEST_F(ExplorationLoopTest, ATargetSeenOnTheWayIsNoAlarm) {
  Begin();
  SendScan(test::FarWall(), now_);
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.replans(), 0U);
  ExpectInterrupted(Interruption::kTargetSeen);
  Report({.path_id = id(), .done = false, .stopped = true, .standing = true, .stamp = {}});
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kDone);
  EXPECT_EQ(test::EndOf(loop_.plan()), Outcome::kComplete);
  EXPECT_TRUE(loop_.order()->T_WBs.empty());
}

/// With a scan each 200 ms for a second.
void Scans(const std::function<void()>& scan, Time& now) {
  for (int n = 0; n < 5; ++n) {
    now += 200ms;
    scan();
  }
}

TEST_F(ExplorationLoopTest, ARobotStopsWhenScansNoLongerReachTheMapAndWaitsForTheNext) {
  Begin();
  const Time first = id();
  Scans([&] { SendScan({}, now_); }, now_);
  now_ += 1s;
  EXPECT_FALSE(loop_.Think(now_));
  now_ += 1ms;
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_TRUE(loop_.order()->T_WBs.empty());
  EXPECT_GT(id(), first);
  ExpectInterrupted(Interruption::kMapSilent);
  EXPECT_EQ(loop_.replans(), 0U);
  EXPECT_EQ(loop_.awaited(), Awaited::kNextScan);
  Report({.path_id = id(), .stopped = true, .standing = true, .stamp = {}});
  for (int second = 0; second < 60; ++second) {
    now_ += 1s;
    EXPECT_FALSE(loop_.Think(now_));
  }
  // A mapper that was restarted sends what it has saved, which says nothing of what is there now.
  Give(WholeMap(test::LongRoom()));
  EXPECT_FALSE(loop_.Think(now_));
  SendScan({}, now_);
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kMoving);
  EXPECT_EQ(loop_.awaited(), Awaited::kNothing);
  ExpectInterrupted(Interruption::kMapSilent);
}

TEST_F(ExplorationLoopTest, ASlowSensorIsNoSilence) {
  Begin();
  for (int scan = 0; scan < 20; ++scan) {
    now_ += 2s;
    SendScan({}, now_);
    loop_.Think(now_);
  }
  now_ += 5s;
  EXPECT_FALSE(loop_.Think(now_));
  EXPECT_FALSE(loop_.last_interruption());
}

TEST_F(ExplorationLoopTest, ARobotThatScansOnlyAtTheEndsOfItsPathsGoesOn) {
  Explorer::Options options = test::GoingOptions();
  options.loop.scan_on_the_way = false;
  loop_ = ExplorationLoop(options);
  Begin();
  Scans([&] { SendScan({}, now_); }, now_);
  now_ += 60s;
  EXPECT_FALSE(loop_.Think(now_));
  EXPECT_FALSE(loop_.last_interruption());
}

TEST_F(ExplorationLoopTest, WhatEndsTheRunEndsItWithoutScansToo) {
  Explorer::Options options = test::GoingOptions();
  options.time_budget = 60s;
  loop_ = ExplorationLoop(options);
  Begin();
  Scans([&] { SendScan({}, now_); }, now_);
  now_ += 10s;
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kPlanning);
  now_ += 60s;
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(test::EndOf(loop_.plan()), Outcome::kTimeBudget);
}

TEST_F(ExplorationLoopTest, AControllerThatStaysStoppedGetsANewPlanAndOneThatGoesOnDoesNot) {
  Begin();
  const Time first = id();
  const MotionNews stopped{.path_id = first, .done = false, .stopped = true, .standing = true, .stamp = {}};
  const MotionNews following{
      .path_id = first, .done = false, .stopped = false, .standing = false, .stamp = {}};
  Report(stopped);
  now_ += 2s;
  Report(following);
  now_ += 2s;
  Report(stopped);
  now_ += 2s;
  Report(stopped);
  EXPECT_FALSE(loop_.Think(now_));
  EXPECT_FALSE(loop_.last_interruption());
  now_ += 2s;
  Report(stopped);
  Report(stopped);
  ExpectInterrupted(Interruption::kControllerStopped);
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_GT(id(), first);
}

TEST_F(ExplorationLoopTest, WhatIsInTheWayOfEveryPathIsNotTriedForEver) {
  Begin();
  for (int time = 0; time < 20 && loop_.state() == LoopState::kMoving; ++time) {
    for (int second = 0; second < 5; ++second) {
      now_ += 1s;
      Report({.path_id = id(), .stopped = true, .blocked = true, .standing = true, .stamp = {}});
    }
    EXPECT_TRUE(loop_.Think(now_));
  }
  EXPECT_EQ(loop_.state(), LoopState::kDone) << "all that it can go for is set aside";
  const auto aside = loop_.explorer().status().set_aside;
  EXPECT_TRUE(std::any_of(aside.begin(), aside.end(),
                          [](const auto& count) { return count.reason == AsideReason::kLostThere; }));
}

TEST_F(ExplorationLoopTest, AControllerThatWaitsForAMessageIsNotHeldAgainstTheTarget) {
  Begin();
  const std::vector<VoxelIndex> target = loop_.explorer().target();
  for (int time = 0; time < 5; ++time) {
    for (int second = 0; second < 5; ++second) {
      now_ += 1s;
      Report({.path_id = id(), .stopped = true, .standing = true, .stamp = {}});
    }
    EXPECT_TRUE(loop_.Think(now_));
    EXPECT_EQ(loop_.state(), LoopState::kMoving);
    EXPECT_EQ(loop_.explorer().target(), target);
  }
  ExpectInterrupted(Interruption::kControllerStopped, 5);
}

TEST_F(ExplorationLoopTest, AReplacedMapInMidRunIsPlannedOnAtOnce) {
  Begin();
  const Time first = id();
  Give(WholeMap(test::ClosedRoom(test::kLongRoom)));
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_GT(id(), first) << "though no time has passed";
  ExpectInterrupted(Interruption::kMapReplaced);
  EXPECT_EQ(loop_.state(), LoopState::kDone);
}

TEST_F(ExplorationLoopTest, AMapOfAnotherVoxelSizeIsTakenUp) {
  Begin();
  Give(WholeMap(test::LongRoom({{0, 0, 0}, {30, 6, 6}}), 0.2));
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kMoving);
  ASSERT_TRUE(loop_.plan().target_W);
  EXPECT_NEAR(loop_.plan().target_W->x(), 6.1, 1e-9);
}

TEST_F(ExplorationLoopTest, AMapThatMakesNoSenseIsRefusedAndTheOneBeforeStays) {
  Begin();
  Explorer::Options options = test::GoingOptions();
  options.bounds = Eigen::AlignedBox3d(Eigen::Vector3d::Zero(), Eigen::Vector3d(7.0, 1.2, 1.2));
  loop_ = ExplorationLoop(options);
  Begin();
  const Time first = id();
  const std::optional<Error> error = loop_.OnMap(WholeMap(test::LongRoom(), 100.0), now_);
  ASSERT_TRUE(error);
  EXPECT_THAT(error->text, testing::HasSubstr("100 m voxels"));
  EXPECT_THAT(error->text, testing::HasSubstr("bounds hold no voxel"));
  EXPECT_FALSE(loop_.Think(now_));
  EXPECT_EQ(id(), first);
}

TEST_F(ExplorationLoopTest, ARobotThatSeesNothingFreeTurnsAndInTheEndSaysSo) {
  Give(WholeMap({}));
  loop_.OnPose(kHere);
  EXPECT_FALSE(loop_.Think(now_)) << "the first scan is still to come";
  EXPECT_EQ(loop_.awaited(), Awaited::kScan);
  RigidTransform T_WB = kHere;
  std::vector<RigidTransform> looks;
  while (loop_.state() != LoopState::kDone) {
    SendScan({}, now_);
    ASSERT_TRUE(loop_.Think(now_));
    if (loop_.state() == LoopState::kDone) break;
    EXPECT_EQ(loop_.state(), LoopState::kLooking);
    ASSERT_EQ(loop_.order()->T_WBs.size(), 1U);
    T_WB = loop_.order()->T_WBs.back();
    EXPECT_EQ(T_WB.translation(), kHere.translation());
    for (const RigidTransform& other : looks) EXPECT_GT(AngleBetween(other, T_WB), 0.5);
    looks.push_back(T_WB);
    ASSERT_LT(looks.size(), 100U);
    loop_.OnPose(T_WB);
    now_ += 1s;
    Report({.path_id = id(), .done = true, .stopped = false, .standing = true, .stamp = {}});
  }
  EXPECT_GE(looks.size(), 12U);
  EXPECT_EQ(test::EndOf(loop_.plan()), Outcome::kNoFreeSpace);
}

TEST_F(ExplorationLoopTest, ARobotThatTurnedAndSawSomethingExploresIt) {
  Give(WholeMap({}));
  loop_.OnPose(kHere);
  SendScan({}, now_);
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kLooking);
  Report({.path_id = id(), .done = true, .stopped = false, .standing = true, .stamp = {}});
  SendScan(test::LongRoom(), now_);
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kMoving);
}

TEST_F(ExplorationLoopTest, ABudgetThatRunsOutOnTheWayEndsTheRunThere) {
  Explorer::Options options = test::GoingOptions();
  options.time_budget = 60s;
  loop_ = ExplorationLoop(options);
  Begin();
  now_ += 59s;
  EXPECT_FALSE(loop_.Think(now_));
  now_ += 1s;
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kDone);
  EXPECT_EQ(test::EndOf(loop_.plan()), Outcome::kTimeBudget);
  EXPECT_TRUE(loop_.order()->T_WBs.empty());

  options.time_budget = 0s;
  options.distance_budget = 2.0;
  loop_ = ExplorationLoop(options);
  Begin();
  loop_.OnPose(test::At(1.55, 0.65, 0.65));
  EXPECT_FALSE(loop_.Think(now_));
  loop_.OnPose(test::At(2.65, 0.65, 0.65));
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(test::EndOf(loop_.plan()), Outcome::kDistanceBudget);
}

TEST_F(ExplorationLoopTest, AClockThatRestartsStopsTheRobotAndBudgetsGoOn) {
  Explorer::Options options = test::GoingOptions();
  options.time_budget = 60s;
  loop_ = ExplorationLoop(options);
  Begin();
  const Time first = id();
  now_ += 10s;
  EXPECT_FALSE(loop_.Think(now_));
  now_ -= 90s;
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_GT(id(), first) << "or the controller would not know it for a new one";
  ExpectInterrupted(Interruption::kClockReset);
  EXPECT_TRUE(loop_.order()->T_WBs.empty());
  Report({.path_id = id(), .done = false, .stopped = true, .standing = true, .stamp = {}});
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kMoving);
  now_ += 49s;
  EXPECT_FALSE(loop_.Think(now_));
  now_ += 1s;
  EXPECT_TRUE(loop_.Think(now_)) << "10 s were used up before";
  EXPECT_EQ(test::EndOf(loop_.plan()), Outcome::kTimeBudget);
}

TEST_F(ExplorationLoopTest, MessagesInDisorderAreNoNewClock) {
  Begin();
  now_ -= 900ms;
  EXPECT_FALSE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kMoving);
}

TEST_F(ExplorationLoopTest, WhatIsDoneStaysDone) {
  Give(WholeMap(test::ClosedRoom(test::kLongRoom)));
  loop_.OnPose(kHere);
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kDone);
  Give(WholeMap(test::LongRoom()));
  EXPECT_FALSE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kDone);
}

/// A room scanned by a sensor and mapped by the mapper, and a robot that is always at the commanded pose.
TEST_F(ExplorationLoopTest, WithAFakeRobotARoomIsExploredToTheEnd) {
  using Box = Eigen::AlignedBox3d;
  using Point = Eigen::Vector3d;
  const thalweg::test::AnalyticRoom room{Box(Point(0.03, 0.04, 0.02), Point(3.04, 2.46, 1.63)),
                                         {Box(Point(1.52, 0.04, 0.02), Point(2.07, 1.13, 0.91))}};
  mapper::OccupancyMap map({.protect = true, .fill = true});
  const RobotModel robot;
  RigidTransform T_WB = test::At(0.7, 1.2, 0.8);
  ExplorationLoop loop{{}};
  const auto scan = [&] {
    const RigidTransform T_WC = T_WB * robot.T_BC;
    const auto changes = map.Integrate(room.Render(DepthSensorModel{}.camera, T_WC), T_WC);
    MapNews news;
    news.voxel_size = 0.1;
    news.changes.assign(changes.begin(), changes.end());
    news.scans = {{.T_WC = T_WC}};
    news.stamp = now_;
    return news;
  };
  EXPECT_FALSE(loop.OnMap(WholeMap(scan().changes), now_));
  int orders = 0;
  while (loop.state() != LoopState::kDone && orders < 200) {
    loop.OnPose(T_WB);
    if (loop.Think(now_)) ++orders;
    now_ += 1s;
    const ExplorationLoop::Order order = *loop.order();
    if (!order.T_WBs.empty()) T_WB = order.T_WBs.back();
    loop.OnPose(T_WB);
    const bool done = !order.T_WBs.empty();
    loop.OnMotion({.path_id = order.id, .done = done, .stopped = !done, .standing = true, .stamp = now_},
                  now_);
    now_ += 1s;
    EXPECT_FALSE(loop.OnMap(scan(), now_));
  }
  EXPECT_EQ(test::EndOf(loop.plan()), Outcome::kComplete);
  EXPECT_LT(orders, 100);
}

}  // namespace
}  // namespace thalweg::explorer
