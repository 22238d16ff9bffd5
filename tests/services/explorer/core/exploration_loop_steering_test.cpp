#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "services/explorer/core/exploration_loop.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

using std::chrono_literals::operator""s;
using test::kHere;
using testing::HasSubstr;

const double kRadius = RobotModel{}.radius;
const double kClearance = kRadius + 0.05;  // [m] With the default margin.

Eigen::AlignedBox3d Box(const Eigen::Vector3d& min_W, const Eigen::Vector3d& max_W) {
  return {min_W, max_W};
}

/// A loop in the long room whose far end is unknown, with a mapper and a controller that report what the test
/// wants.
class Steering : public testing::Test {
 protected:
  void Begin(const std::vector<VoxelChange>& map = test::LongRoom()) {
    MapNews news;
    news.replaced = true;
    news.voxel_size = 0.1;
    news.changes = map;
    ASSERT_FALSE(loop_.OnMap(news, now_));
    loop_.OnPose(kHere);
    ASSERT_TRUE(loop_.Think(now_));
    ASSERT_EQ(loop_.state(), LoopState::kMoving);
  }
  void Scan(const std::vector<VoxelChange>& changes = {}) {
    MapNews news;
    news.voxel_size = 0.1;
    news.changes = changes;
    news.scans = {{.T_WC = kHere * RobotModel{}.T_BC}};
    news.stamp = now_;
    ASSERT_FALSE(loop_.OnMap(news, now_));
  }
  void Report(bool done) {
    now_ += 1s;
    MotionNews news{
        .path_id = loop_.order()->id, .done = done, .stopped = !done, .standing = true, .stamp = now_};
    loop_.OnMotion(news, now_);
  }
  /// The robot has come to rest after a stop.
  void Stand() {
    ASSERT_TRUE(loop_.order()->T_WBs.empty()) << "it was not stopped";
    Report(false);
  }
  /// The robot arrives at the end of its path and scans there.
  void Arrive() {
    loop_.OnPose(loop_.order()->T_WBs.back());
    Report(true);
    Scan();
  }
  Answer Obey(const Command& command) { return loop_.Obey(command, now_); }
  void Accept(const Command& command) {
    const Answer answer = Obey(command);
    EXPECT_TRUE(answer.accepted) << answer.text;
    EXPECT_FALSE(answer.text.empty());
  }
  void Refuse(const Command& command, const std::string& why) {
    const auto order = loop_.order()->id;
    const LoopState state = loop_.state();
    const Answer answer = Obey(command);
    EXPECT_FALSE(answer.accepted);
    EXPECT_THAT(answer.text, HasSubstr(why));
    EXPECT_EQ(loop_.order()->id, order) << "a refused command changes nothing";
    EXPECT_EQ(loop_.state(), state);
  }
  static Command GoTo(const Eigen::Vector3d& p_W, std::optional<double> yaw = {}) {
    return command::Run{{.kind = Errand::Kind::kGoTo, .p_W = p_W, .yaw_W = yaw}};
  }
  static Command LookAt(const Eigen::Vector3d& p_W) {
    return command::Run{{.kind = Errand::Kind::kLookAt, .p_W = p_W, .yaw_W = {}}};
  }
  std::size_t plans() const { return loop_.explorer().status().plans; }
  /// The least distance between the order's path and a box.
  double GapTo(const Eigen::AlignedBox3d& box) const {
    double least = 1e9;
    const auto& T_WBs = loop_.order()->T_WBs;
    for (std::size_t n = 1; n < T_WBs.size(); ++n) {
      for (double share = 0.0; share <= 1.0; share += 0.01) {
        const Eigen::Vector3d p_W =
            (1.0 - share) * T_WBs[n - 1].translation() + share * T_WBs[n].translation();
        least = std::min(least, box.exteriorDistance(p_W));
      }
    }
    return least;
  }

  Time now_{100s};
  ExplorationLoop loop_{test::GoingOptions()};
};

TEST_F(Steering, PauseStopsTheRobotOnItsPathAndResumePlansOnceItStands) {
  Begin();
  loop_.OnPose(test::At(1.5, 0.65, 0.65));
  Accept(command::Pause{});
  EXPECT_TRUE(loop_.order()->T_WBs.empty()) << "an empty path is a stop, and it is sent at once";
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kPaused);
  Stand();
  Scan();
  EXPECT_FALSE(loop_.Think(now_));
  EXPECT_EQ(plans(), 1U);
  Accept(command::Pause{});
  Accept(command::Resume{});
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kMoving);
  EXPECT_NEAR(loop_.order()->T_WBs.front().translation().x(), 1.5, 1e-9) << "from where it stands";
  EXPECT_EQ(loop_.interruptions().at(Interruption::kOperator), 1U);
  EXPECT_EQ(loop_.replans(), 0U);
}

TEST_F(Steering, ResumeBeforeTheRobotStandsStillWaitsUntilItDoes) {
  Begin();
  Accept(command::Pause{});
  Accept(command::Resume{});
  loop_.Think(now_);
  EXPECT_EQ(plans(), 1U);
  Stand();
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(plans(), 2U);
}

TEST_F(Steering, APauseBeforeTheMapHasComeHoldsTheFirstPlan) {
  Accept(command::Pause{});
  MapNews news;
  news.replaced = true;
  news.voxel_size = 0.1;
  news.changes = test::LongRoom();
  ASSERT_FALSE(loop_.OnMap(news, now_));
  loop_.OnPose(kHere);
  loop_.Think(now_);
  EXPECT_EQ(loop_.state(), LoopState::kPaused);
  EXPECT_FALSE(loop_.order());
  Accept(command::Resume{});
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kMoving);
}

TEST_F(Steering, WhatMakesNoSenseNowIsRefusedWithItsReason) {
  Begin();
  Refuse(command::Resume{}, "nothing to resume");
  Refuse(command::ClearNoGo{}, "no drawn no-go box");
  Refuse(command::UseStrategy{"clsest"}, "clsest");
  Accept(command::Stop{});
  EXPECT_EQ(loop_.state(), LoopState::kDone);
  for (const Command& command : {Command(command::Pause{}), Command(command::Resume{}),
                                 Command(command::GoHome{}), GoTo({1, 0.65, 0.65})}) {
    Refuse(command, "the exploration has ended");
    const Answer answer = Obey(command);
    ASSERT_TRUE(answer.ended);
    EXPECT_EQ(answer.ended->outcome, Outcome::kOperator);
  }
}

TEST_F(Steering, AStepMakesOneDecisionCarriesItOutAndPauses) {
  Begin();
  Accept(command::Step{});
  EXPECT_FALSE(loop_.order()->T_WBs.empty()) << "the present decision is finished";
  Arrive();
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kPaused);
  EXPECT_EQ(loop_.pause_cause().reason, PauseReason::kStepDone);
  EXPECT_EQ(plans(), 1U);
  Accept(command::Step{});
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(plans(), 2U);
  ASSERT_NE(loop_.state(), LoopState::kPaused);
  if (loop_.state() == LoopState::kDone) return;
  Arrive();
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kPaused);
  EXPECT_EQ(plans(), 2U);
}

TEST_F(Steering, StopEndsTheExplorationWhereTheRobotIs) {
  Begin();
  Accept(command::Stop{});
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kDone);
  EXPECT_EQ(test::EndOf(loop_.plan()), Outcome::kOperator);
  EXPECT_FALSE(loop_.plan().ending->succeeded());
  EXPECT_TRUE(loop_.order()->T_WBs.empty());
}

TEST_F(Steering, HomeLeadsBackToTheStartEvenIfTheRobotNeedNotReturn) {
  Begin();
  Arrive();
  loop_.Think(now_);
  const RigidTransform far = test::At(4.0, 0.65, 0.65);
  loop_.OnPose(far);
  Accept(command::Pause{});
  Accept(command::GoHome{});
  if (loop_.order()->T_WBs.empty()) Stand();
  ASSERT_TRUE(loop_.Think(now_)) << "home comes before the pause";
  EXPECT_EQ(loop_.plan().purpose, Purpose::kGoHome);
  EXPECT_EQ(loop_.plan().homeward, Outcome::kOperator);
  EXPECT_LT((loop_.order()->T_WBs.back().translation() - kHere.translation()).norm(), 0.15);
  Refuse(GoTo({2.0, 0.65, 0.65}), "on its way home");
  Arrive();
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_EQ(test::EndOf(loop_.plan()), Outcome::kOperator);
  EXPECT_TRUE(loop_.plan().homeward);
}

TEST_F(Steering, GoToLeadsToTheGoalOnAClearPathAndThenWaits) {
  Begin();
  Accept(GoTo({3.0, 0.35, 0.85}, 0.5 * std::numbers::pi));
  Stand();
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kMoving);
  EXPECT_EQ(loop_.plan().purpose, Purpose::kGoTo);
  const RigidTransform end = loop_.order()->T_WBs.back();
  EXPECT_LT((end.translation() - Eigen::Vector3d(3.0, 0.35, 0.85)).norm(), 0.1) << "within a voxel";
  EXPECT_NEAR(YawOf(end.linear()), 0.5 * std::numbers::pi, 1e-6);
  const auto room = Box({0, 0, 0}, {6.0, 1.2, 1.2});
  for (const RigidTransform& T_WB : loop_.order()->T_WBs) {
    const Eigen::Vector3d p = T_WB.translation();
    EXPECT_GE(std::min((p - room.min()).minCoeff(), (room.max() - p).minCoeff()), kClearance - 1e-6);
  }
  Arrive();
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kPaused);
  EXPECT_EQ(loop_.pause_cause().reason, PauseReason::kErrandDone);
  EXPECT_EQ(plans(), 2U);
  Accept(command::Resume{});
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.plan().purpose, Purpose::kSeeFrontier);
}

TEST_F(Steering, AGoalWhereTheRobotCannotBeIsRefused) {
  std::vector<VoxelChange> map = test::LongRoom({{0, 0, 0}, {60, 24, 12}});
  const std::vector<VoxelChange> cell = test::ClosedRoom({{30, 2, 2}, {40, 10, 10}});
  map.insert(map.end(), cell.begin(), cell.end());
  Begin(map);
  Refuse(GoTo({8.0, 0.65, 0.65}), "not known yet");
  Refuse(GoTo({1.0, -0.05, 0.65}), "in an obstacle");
  Refuse(GoTo({1.0, 0.05, 0.65}), "too near");
  Refuse(GoTo({3.55, 0.65, 0.65}), "no known path");
  Explorer::Options options = test::GoingOptions();
  options.bounds = Box({0, 0, 0}, {7.0, 1.2, 1.2});
  loop_ = ExplorationLoop(options);
  Begin();
  Refuse(GoTo({7.5, 0.65, 0.65}), "outside the bounds");
}

TEST_F(Steering, AGoalBeyondTheBudgetForTheWayBackIsRefused) {
  Explorer::Options options = test::GoingOptions();
  options.return_home = true;
  options.distance_budget = 6.0;  // 2.5 m out, and back with its reserve: 2.5 + 1.15 * 2.5 + 0.5
  loop_ = ExplorationLoop(options);
  MapNews news;
  news.replaced = true;
  news.voxel_size = 0.1;
  news.changes = test::LongRoom();
  ASSERT_FALSE(loop_.OnMap(news, now_));
  loop_.OnPose(kHere);
  Accept(command::Pause{});
  loop_.Think(now_);
  Accept(GoTo({1.5, 0.65, 0.65}));
  ASSERT_TRUE(loop_.Think(now_));
  Refuse(GoTo({4.0, 0.65, 0.65}), "distance budget");
}

TEST_F(Steering, AnErrandIsPlannedAgainWhenItsPathIsBlockedAndGivenUpWhenNoneIsLeft) {
  Begin();
  Accept(GoTo({4.0, 0.65, 0.65}));
  Stand();
  ASSERT_TRUE(loop_.Think(now_));
  Scan(test::ObstacleAt({2.0, 0.65, 0.65}));
  EXPECT_EQ(loop_.last_interruption(), Interruption::kPathBlocked) << "checked as every other path";
  Stand();
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.plan().purpose, Purpose::kGoTo);
  EXPECT_GE(GapTo(Box({2.0, 0.6, 0.6}, {2.1, 0.7, 0.7})), kRadius);
  Scan(test::BoxOf({{30, 0, 0}, {31, 12, 12}}, VoxelState::kOccupied));
  Stand();
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kPaused);
  EXPECT_EQ(loop_.pause_cause().reason, PauseReason::kErrandImpossible);
  EXPECT_THAT(loop_.pause_cause().error, HasSubstr("no known path"));
  EXPECT_TRUE(loop_.order()->T_WBs.empty());
}

TEST_F(Steering, ResumeInsteadOfAnErrandGoesOnExploring) {
  Begin();
  Accept(GoTo({1.5, 0.65, 0.65}));
  Stand();
  ASSERT_TRUE(loop_.Think(now_));
  Accept(command::Resume{});
  Stand();
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.plan().purpose, Purpose::kSeeFrontier);
}

TEST_F(Steering, LookAtTurnsTheCameraToThePointAndWaits) {
  Begin();
  const Eigen::Vector3d point_W(0.55, -0.05, 0.65);  // to the robot's right
  Accept(LookAt(point_W));
  Stand();
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.plan().purpose, Purpose::kLookAt);
  ASSERT_EQ(loop_.order()->T_WBs.size(), 1U) << "it is in sight from here";
  const RigidTransform T_WC = loop_.order()->T_WBs.front() * RobotModel{}.T_BC;
  const Eigen::Vector3d p_C = T_WC.inverse() * point_W;
  EXPECT_LT(p_C.head<2>().norm(), 0.25 * p_C.z()) << "near the middle of the image";
  Arrive();
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.state(), LoopState::kPaused);
  Refuse(LookAt({30.0, 0.0, 0.0}), "no place that the robot can reach");
}

TEST_F(Steering, LookAtGoesToWhereThePointCanBeSeen) {
  // A wall at 3 m that leaves a gap on the far side of the room: the point behind it is out of sight.
  std::vector<VoxelChange> map = test::LongRoom({{0, 0, 0}, {60, 24, 12}});
  test::Fill(map, {{30, 0, 0}, {31, 16, 12}}, VoxelState::kOccupied);
  Begin(map);
  const Eigen::Vector3d point_W(3.55, 0.05, 0.65);
  Accept(LookAt(point_W));
  Stand();
  ASSERT_TRUE(loop_.Think(now_));
  if (loop_.plan().faces_passage_first) {
    Arrive();
    ASSERT_TRUE(loop_.Think(now_));
  }
  ASSERT_EQ(loop_.plan().kind, Plan::Kind::kGo);
  const RigidTransform end = loop_.order()->T_WBs.back();
  EXPECT_TRUE(loop_.explorer().map().InSight(end.translation(), point_W));
  EXPECT_TRUE(DepthSensorModel{}.camera.Sees((end * RobotModel{}.T_BC).inverse() * point_W));
}

TEST_F(Steering, AnIgnoredFrontierIsNoLongerGoneForAndNeverComesBack) {
  Begin();
  Accept(command::Ignore{{6.05, 0.65, 0.65}});
  for (int more = 0; more < 20 && Obey(command::Ignore{{6.05, 0.65, 0.65}}).accepted; ++more) {
  }
  Refuse(command::Ignore{{6.05, 0.65, 0.65}}, "no frontier");
  ASSERT_EQ(loop_.last_interruption(), Interruption::kOperator) << "it was on its way there";
  now_ += 3600s;
  Stand();
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_EQ(test::EndOf(loop_.plan()), Outcome::kComplete);
  const auto aside = loop_.explorer().status().set_aside;
  ASSERT_EQ(aside.size(), 1U);
  EXPECT_EQ(aside[0].reason, AsideReason::kIgnored);
  EXPECT_EQ(aside[0].voxels, 144U);
}

TEST_F(Steering, ANoGoBoxAcrossThePathStopsTheRobotAndTheNextPathGoesAround) {
  Begin();
  const auto box = Box({2.0, 0.0, 0.0}, {2.5, 0.6, 1.2});
  Accept(command::DrawNoGo{box});
  EXPECT_EQ(loop_.last_interruption(), Interruption::kPathBlocked);
  Stand();
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_GT(loop_.order()->T_WBs.back().translation().x(), 4.0);
  EXPECT_GE(GapTo(box), kRadius);
  Refuse(GoTo({2.25, 0.3, 0.6}), "in a no-go box");
  ASSERT_EQ(loop_.explorer().standing().drawn_no_go.size(), 1U);
  Accept(command::ClearNoGo{});
  EXPECT_TRUE(loop_.explorer().standing().drawn_no_go.empty());
  Accept(GoTo({2.25, 0.35, 0.6}));
}

TEST_F(Steering, ABoxAwayFromThePathInterruptsNothing) {
  Begin();
  const Time order = loop_.order()->id;
  Accept(command::DrawNoGo{Box({2.0, 0.0, 0.0}, {2.5, 0.2, 0.2})});
  EXPECT_EQ(loop_.order()->id, order);
  EXPECT_FALSE(loop_.last_interruption());
}

TEST_F(Steering, ARobotInsideANewBoxLeavesItFirstAndThenStaysOut) {
  Begin();
  const auto box = Box({0.2, 0.0, 0.0}, {1.3, 1.2, 1.2});
  Accept(command::DrawNoGo{box});
  Stand();
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.plan().purpose, Purpose::kLeaveNoGo);
  EXPECT_GE(box.exteriorDistance(loop_.order()->T_WBs.back().translation()), kClearance - 1e-6);
  if (loop_.plan().faces_passage_first) {
    Arrive();
    ASSERT_TRUE(loop_.Think(now_));
  }
  Arrive();
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.plan().purpose, Purpose::kSeeFrontier);
  EXPECT_GE(GapTo(box), kRadius);
  Refuse(GoTo({0.6, 0.6, 0.6}), "in a no-go box");
}

TEST_F(Steering, ABoxThatLeavesNoWayOutIsRefused) {
  Begin();
  Refuse(command::DrawNoGo{Box({-1, -1, -1}, {9, 3, 3})}, "no known path leads out");
  EXPECT_TRUE(loop_.explorer().standing().drawn_no_go.empty());
  EXPECT_FALSE(loop_.explorer().standing().in_no_go);
}

TEST_F(Steering, ABoxThatCutsARobotOffFromItsHomeIsRefused) {
  Explorer::Options options = test::GoingOptions();
  options.return_home = true;
  loop_ = ExplorationLoop(options);
  Begin();
  loop_.OnPose(test::At(4.0, 0.65, 0.65));
  Refuse(command::DrawNoGo{Box({2.0, 0.0, 0.0}, {2.5, 1.2, 1.2})}, "cut the robot off");
  Refuse(command::DrawNoGo{Box({0.5, 0.6, 0.6}, {0.7, 0.7, 0.7})},
         "the place to which the robot must return");
  Accept(command::DrawNoGo{Box({2.0, 0.0, 0.0}, {2.5, 0.5, 1.2})});
}

TEST_F(Steering, ABoxAroundTheRobotIsLeftOnTheSideOfItsHome) {
  Explorer::Options options = test::GoingOptions();
  options.return_home = true;
  loop_ = ExplorationLoop(options);
  Begin();
  loop_.OnPose(test::At(3.05, 0.65, 0.65));
  const auto box = Box({2.0, -0.1, -0.1}, {3.4, 1.3, 1.3});  // the far side is nearer
  Accept(command::DrawNoGo{box});
  Stand();
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.plan().purpose, Purpose::kLeaveNoGo);
  EXPECT_LT(loop_.order()->T_WBs.back().translation().x(), 2.0);
}

TEST_F(Steering, HomeInADrawnBoxIsRefusedAndARobotThatIsThereHasArrived) {
  Begin();
  loop_.OnPose(test::At(4.0, 0.65, 0.65));
  Accept(command::DrawNoGo{Box({0.3, 0.3, 0.3}, {1.0, 1.0, 1.0})});
  Refuse(command::GoHome{}, "covers the place where the robot set out");
  Accept(command::ClearNoGo{});
  Accept(command::GoHome{});
  Refuse(command::DrawNoGo{Box({0.3, 0.3, 0.3}, {1.0, 1.0, 1.0})}, "must return");
}

TEST_F(Steering, WhatIsIgnoredStaysSoWhenTheMapperSendsAWholeMap) {
  Begin();
  while (Obey(command::Ignore{{6.05, 0.65, 0.65}}).accepted) {
  }
  Stand();
  MapNews news;
  news.replaced = true;
  news.voxel_size = 0.1;
  news.changes = test::LongRoom();
  ASSERT_FALSE(loop_.OnMap(news, now_));
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_EQ(test::EndOf(loop_.plan()), Outcome::kComplete);
}

TEST_F(Steering, ARobotOnItsWayHomeGoesOnWhenTheVoxelSizeChanges) {
  Begin();
  loop_.OnPose(test::At(4.0, 0.65, 0.65));
  Accept(command::GoHome{});
  MapNews news;
  news.replaced = true;
  news.voxel_size = 0.2;
  news.changes = test::LongRoom({{0, 0, 0}, {30, 6, 6}});
  ASSERT_FALSE(loop_.OnMap(news, now_));
  if (loop_.order()->T_WBs.empty()) Stand();
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.plan().purpose, Purpose::kGoHome);
  EXPECT_LT((loop_.order()->T_WBs.back().translation() - kHere.translation()).norm(), 0.15);
}

TEST_F(Steering, AFrontierThatIsSetAsideForAnotherReasonCanBeIgnored) {
  Begin();
  Arrive();  // and the scan shows nothing new
  loop_.Think(now_);
  const auto aside = loop_.explorer().status().set_aside;
  ASSERT_TRUE(
      std::ranges::any_of(aside, [](const auto& count) { return count.reason == AsideReason::kVisited; }));
  Answer answer;
  std::size_t commands = 0;
  do {
    answer = Obey(command::Ignore{{6.05, 0.65, 0.65}});
  } while (answer.accepted && ++commands < 50);
  for (const auto& count : loop_.explorer().status().set_aside)
    EXPECT_EQ(count.reason, AsideReason::kIgnored);
}

TEST_F(Steering, APointWithoutAFrontierNearbyIgnoresNone) {
  Begin();
  Refuse(command::Ignore{{30.0, 0.65, 0.65}}, "the frontier nearest to (30.00, 0.65, 0.65) is at (6");
}

TEST_F(Steering, AnotherStrategyDecidesFromTheNextDecisionOn) {
  Begin();
  const Time order = loop_.order()->id;
  Accept(command::UseStrategy{"potential_flux"});
  EXPECT_EQ(loop_.order()->id, order) << "the present decision stays";
  EXPECT_EQ(loop_.explorer().standing().strategy, "potential_flux");
  Accept(command::Pause{});
  Stand();
  Accept(command::Resume{});
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_NE(loop_.explorer().field(), nullptr) << "closest computes no field";
}

}  // namespace
}  // namespace thalweg::explorer
