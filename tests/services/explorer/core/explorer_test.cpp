#include "services/explorer/core/explorer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "tests/services/explorer/support/choosing_explorer.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

using std::chrono_literals::operator""s;
using ExplorerTest = test::ChoosingExplorer;
using test::kHere;
using test::kStart;

constexpr VoxelBox kHole{{16, 5, 5}, {18, 8, 8}};

INSTANTIATE_TEST_SUITE_P(Strategies, ExplorerTest, testing::ValuesIn(test::ChoosingStrategies()),
                         [](const auto& its) { return std::string(its.param); });

TEST(Explorer, MostStrategiesChooseAmongItsCandidates) {
  EXPECT_GE(test::ChoosingStrategies().size(), 9U) << "the tests run for each of them";
}

TEST_P(ExplorerTest, ARoomThatIsAllKnownIsComplete) {
  Explorer explorer = With(options_, test::ClosedRoom(test::kLongRoom));
  const Plan plan = explorer.MakePlan(kHere, kStart);
  EXPECT_EQ(plan.kind, Plan::Kind::kDone);
  EXPECT_EQ(test::EndOf(plan), Outcome::kComplete);
  EXPECT_TRUE(plan.T_WBs.empty());
  EXPECT_EQ(explorer.status().frontiers_left, 0U);
}

/// Finds nothing worth its path.
class Contented final : public Strategy {
 public:
  Choice Choose(const Situation& /*situation*/) override { return {}; }
};

Explorer Content(const std::vector<VoxelChange>& changes) {
  Explorer::Options options = test::GoingOptions();
  options.strategy = {"contented", [] { return std::make_unique<Contented>(); }};
  Explorer explorer(options);
  explorer.Update(changes, {}, kStart);
  return explorer;
}

TEST(Explorer, EndsWhenTheLittleThatIsLeftIsNotWorthItsPathAndSaysSo) {
  std::vector<VoxelChange> changes = test::LongRoom();
  for (const VoxelChange& wall : test::BoxOf({{60, 2, 0}, {61, 12, 12}}, VoxelState::kOccupied))
    changes.push_back(wall);
  const Plan plan = Content(changes).MakePlan(kHere, kStart);
  EXPECT_EQ(plan.kind, Plan::Kind::kDone);
  EXPECT_EQ(test::EndOf(plan), Outcome::kComplete);
  EXPECT_EQ(plan.ending->left_frontiers, 2U);
  EXPECT_NEAR(plan.ending->left_area, 0.24, 1e-9);  // 24 voxels at the far end, 0.8 % of the border
  EXPECT_TRUE(plan.ending->missed.empty());
}

TEST(Explorer, EndsByTheBudgetWhenOnlyWhatItDoesNotAllowMayBeWorthThePath) {
  std::vector<VoxelChange> changes = test::LongRoom();
  const VoxelBox hole{{20, 12, 5}, {26, 13, 8}};  // in a side wall, much nearer than the far end
  std::erase_if(changes, [&](const VoxelChange& change) { return hole.Contains(change.voxel); });
  Explorer::Options options = test::GoingOptions();
  options.strategy = {"contented", [] { return std::make_unique<Contented>(); }};
  options.distance_budget = 8.0;
  options.return_home = true;
  Explorer explorer(options);
  explorer.Update(changes, {}, kStart);
  EXPECT_EQ(test::EndOf(explorer.MakePlan(kHere, kStart)), Outcome::kDistanceBudget);
}

TEST(Explorer, GoesOnWhenWhatIsLeftIsMuchWhateverItIsWorth) {
  const Plan plan = Content(test::LongRoom()).MakePlan(kHere, kStart);  // 4.5 % of the border
  EXPECT_EQ(plan.kind, Plan::Kind::kGo);
  EXPECT_GT(plan.target_unknown, 0U);
}

TEST_P(ExplorerTest, ARobotThatIsShutInSaysThatNothingIsReachable) {
  std::vector<VoxelChange> changes = test::LongRoom();
  const std::vector<VoxelChange> cell = test::ClosedRoom({{4, 4, 4}, {8, 8, 8}});
  changes.insert(changes.end(), cell.begin(), cell.end());
  Explorer explorer = With(options_, changes);
  const Plan plan = explorer.MakePlan(test::At(0.6, 0.6, 0.6), kStart);
  EXPECT_EQ(plan.kind, Plan::Kind::kDone);
  EXPECT_EQ(test::EndOf(plan), Outcome::kNothingReachable);
}

/// The long room with a wall across it, in which there is a hole of 0.3 m.
std::vector<VoxelChange> CellAndRoom() {
  std::vector<VoxelChange> changes = test::LongRoom();
  test::Fill(changes, {{16, 0, 0}, {18, 12, 12}}, VoxelState::kOccupied);
  test::Fill(changes, kHole, VoxelState::kFree);
  return changes;
}

/// From the room through the middle of the hole into the cell, where the robot does not fit through it any
/// more with its margin.
void ComeIn(Explorer& explorer) {
  for (double x = 3.05; x > 0.5; x -= 0.1) explorer.Move(test::At(x, 0.65, 0.65));
}

TEST_P(ExplorerTest, ARobotThatIsShutInGoesBackTheWayItCame) {
  options_.safety_margin = 0.1;
  Explorer explorer = With(options_, CellAndRoom());
  ComeIn(explorer);
  const Plan plan = explorer.MakePlan(kHere, kStart);
  EXPECT_EQ(plan.kind, Plan::Kind::kGo);
  ASSERT_EQ(plan.purpose, Purpose::kGoBack);
  EXPECT_NEAR(plan.T_WBs.back().translation().x(), 2.0, 0.1);
  EXPECT_FALSE(explorer.CheckPlan(kHere));

  const Plan there = explorer.MakePlan(plan.T_WBs.back(), kStart);
  EXPECT_EQ(there.purpose, Purpose::kSeeFrontier) << "which it can reach from there";

  explorer.Update(test::BoxOf(kHole, VoxelState::kOccupied), {}, kStart);
  EXPECT_EQ(test::EndOf(explorer.MakePlan(kHere, kStart)), Outcome::kNothingReachable) << "shut since";
}

TEST_P(ExplorerTest, AnExplorerThatTakesOverKnowsTheWayBack) {
  options_.safety_margin = 0.1;
  Explorer before = With(options_, CellAndRoom());
  ComeIn(before);
  Explorer explorer = With(options_, CellAndRoom());
  explorer.TakeOverFrom(before);
  EXPECT_EQ(explorer.MakePlan(kHere, kStart).purpose, Purpose::kGoBack);
}

TEST_P(ExplorerTest, ARobotThatComesNoNearerOnItsWayBackGivesUp) {
  options_.safety_margin = 0.1;
  Explorer explorer = With(options_, CellAndRoom());
  ComeIn(explorer);
  for (const double x : {0.55, 0.65, 0.75, 0.75, 0.75})
    ASSERT_EQ(explorer.MakePlan(test::At(x, 0.65, 0.65), kStart).purpose, Purpose::kGoBack) << x;
  EXPECT_EQ(test::EndOf(explorer.MakePlan(test::At(0.75, 0.65, 0.65), kStart)), Outcome::kNothingReachable);
}

TEST_P(ExplorerTest, AnOperatorsWordIsANewBeginningForARobotOnItsWayBack) {
  options_.safety_margin = 0.1;
  Explorer explorer = With(options_, CellAndRoom());
  ComeIn(explorer);
  for (int time = 0; time < 5; ++time) {
    ASSERT_EQ(explorer.MakePlan(kHere, kStart).purpose, Purpose::kGoBack) << time;
    explorer.Abandon();
  }
}

TEST(Explorer, EndsWhenTheRobotGetsNowhereWhereItWouldInspectSurface) {
  Explorer::Options options = test::GoingOptions();
  options.strategy = Configure("surface");
  Explorer explorer(options);
  explorer.Update(test::ClosedRoom(test::kLongRoom), {}, kStart);
  int plans = 0;
  for (Time now = kStart; !explorer.MakePlan(kHere, now).ending && plans < 1000; now += 4s, ++plans)
    explorer.DidNotGetThere(now);
  EXPECT_LT(plans, 1000);
}

TEST_P(ExplorerTest, InThePrintedLoopNobodyGoesBack) {
  options_.safety_margin = 0.1;
  options_.loop.go_tight_ways = false;
  Explorer explorer = With(options_, CellAndRoom());
  explorer.MakePlan(test::At(3.05, 0.65, 0.65), kStart);
  ComeIn(explorer);
  EXPECT_TRUE(explorer.SendHome(kHere));
  EXPECT_EQ(test::EndOf(explorer.MakePlan(kHere, kStart)), Outcome::kNothingReachable);
}

TEST_P(ExplorerTest, ARobotOnItsWayHomeThatIsShutInGoesBackTheWayItCame) {
  options_.safety_margin = 0.1;
  options_.return_home = true;
  Explorer explorer = With(options_, test::LongRoom());
  explorer.MakePlan(test::At(3.05, 0.65, 0.65), kStart);
  ComeIn(explorer);
  ASSERT_FALSE(explorer.SendHome(kHere));
  explorer.Update(CellAndRoom(), {}, kStart);
  EXPECT_EQ(explorer.MakePlan(kHere, kStart).purpose, Purpose::kGoBack);

  explorer.Update(test::BoxOf(kHole, VoxelState::kOccupied), {}, kStart);
  Plan plan = explorer.MakePlan(kHere, kStart);
  EXPECT_EQ(plan.kind, Plan::Kind::kGo) << "to where the way is shut";
  ASSERT_EQ(plan.purpose, Purpose::kWatchShutWay);
  const RigidTransform before = plan.T_WBs.back();
  EXPECT_GT(before.translation().x(), 1.3);
  EXPECT_GT(before.linear().col(0).x(), 0.99) << "it faces the hole at x = 1.6 m";

  const auto watch_from = [&](Time begin) {
    int seconds = 0;
    for (; seconds < 100; ++seconds) {
      plan = explorer.MakePlan(before, begin + seconds * 1s);
      if (plan.ending) break;
      EXPECT_EQ(plan.kind, Plan::Kind::kLook);
      EXPECT_EQ(plan.purpose, Purpose::kWatchShutWay);
    }
    return seconds;
  };
  EXPECT_EQ(watch_from(kStart), 31);
  EXPECT_EQ(test::EndOf(plan), Outcome::kNoPathHome);
  explorer.Update(test::BoxOf(kHole, VoxelState::kFree), {}, kStart);
  EXPECT_EQ(explorer.MakePlan(before, kStart + 60s).purpose, Purpose::kGoHome) << "it is open again";
}

TEST_P(ExplorerTest, ARobotSentHomeFromBeyondATightPassageGoesBackThroughIt) {
  options_.safety_margin = 0.1;
  Explorer explorer = With(options_, CellAndRoom());
  explorer.MakePlan(test::At(3.05, 0.65, 0.65), kStart);
  EXPECT_TRUE(explorer.SendHome(kHere)) << "it has not come that way";
  ComeIn(explorer);
  ASSERT_FALSE(explorer.SendHome(kHere));
  const Plan back = explorer.MakePlan(kHere, kStart);
  ASSERT_EQ(back.purpose, Purpose::kGoBack);
  const Plan home = explorer.MakePlan(back.T_WBs.back(), kStart);
  EXPECT_EQ(home.purpose, Purpose::kGoHome);
  EXPECT_NEAR(home.T_WBs.back().translation().x(), 3.05, 1e-9);
}

TEST_P(ExplorerTest, ARobotThatDrivesWithItsBodyInTheFloorSaysThatNothingIsReachable) {
  options_.robot.drives = true;
  options_.robot.height = 1.4;  // from 0.1 m below the floor to 0.1 m above the ceiling
  Explorer explorer = With(options_, test::LongRoom());
  const Plan plan = explorer.MakePlan(test::At(0.65, 0.65, 0.6), kStart);
  EXPECT_EQ(plan.kind, Plan::Kind::kDone);
  EXPECT_EQ(test::EndOf(plan), Outcome::kNothingReachable) << "not complete: it cannot move at all";
}

TEST_P(ExplorerTest, ARobotInANarrowPlaceLeavesItThoughNothingIsInSightFromWithin) {
  // A burrow of 3 x 3 voxels that ends in the room: the robot with its margin fits nowhere in it.
  options_.safety_margin = 0.1;
  std::vector<VoxelChange> changes = test::LongRoom();
  const VoxelBox burrow{{-8, 5, 5}, {0, 8, 8}};
  for (const VoxelChange& change : test::ClosedRoom(burrow)) {
    if (change.voxel.x < 0 || burrow.Contains(change.voxel)) changes.push_back(change);
  }
  for (const VoxelChange& change : test::BoxOf({{-1, 5, 5}, {0, 8, 8}}, VoxelState::kFree)) {
    changes.push_back(change);
  }
  Explorer explorer = With(options_, changes);
  const Plan plan = explorer.MakePlan(test::At(-0.55, 0.65, 0.65), kStart);
  ASSERT_EQ(plan.kind, Plan::Kind::kGo);
  EXPECT_GT(plan.T_WBs.back().translation().x(), 4.5);
}

TEST_P(ExplorerTest, GoesToAFrontierAndFacesItAtTheEnd) {
  Explorer explorer = With(options_, test::LongRoom());
  const Plan plan = explorer.MakePlan(kHere, kStart);
  ASSERT_EQ(plan.kind, Plan::Kind::kGo);
  EXPECT_FALSE(plan.ending);
  EXPECT_LT((plan.T_WBs.front().translation() - kHere.translation()).norm(), 1e-9);
  EXPECT_GT(plan.T_WBs.back().translation().x(), 4.5);
  EXPECT_GT(plan.T_WBs.back().linear()(0, 0), 0.5) << "the body's x axis points to the far end";
  ASSERT_TRUE(plan.target_W);
  EXPECT_NEAR(plan.target_W->x(), 6.05, 1e-9);
  EXPECT_EQ(explorer.status().frontier_voxels_left, 144U);
  int chosen = 0;
  for (const FrontierReport& report : explorer.frontier_reports()) {
    EXPECT_NE(report.fate, FrontierReport::Fate::kSetAside);
    if (report.fate != FrontierReport::Fate::kChosen) continue;
    ++chosen;
    EXPECT_EQ(report.center_W, *plan.target_W);
  }
  EXPECT_EQ(chosen, 1);
  EXPECT_GE(explorer.chosen_path_W().size(), 2U);
}

/// The long room with a wall across at 3 m, which has a hole of 0.3 x 0.3 m. The unknown end lies behind it,
/// too far away to be seen from in front of it.
std::vector<VoxelChange> RoomBehindAHole() {
  std::vector<VoxelChange> changes = test::LongRoom({{0, 0, 0}, {90, 12, 12}});
  test::Fill(changes, {{30, 0, 0}, {31, 12, 12}}, VoxelState::kOccupied);
  test::Fill(changes, {{30, 5, 5}, {31, 8, 8}}, VoxelState::kFree);
  return changes;
}

/// Right in front of the hole.
const RigidTransform kLookingBack =
    MakeTransform(RotationFromYawPitch(std::numbers::pi, 0.0), {2.65, 0.65, 0.65});

TEST_P(ExplorerTest, TurnsToANarrowPassageBeforeItSetsOutAndThenTakesThePathItChose) {
  Explorer explorer = With(options_, RoomBehindAHole());
  const Plan turn = explorer.MakePlan(kLookingBack, kStart);
  ASSERT_EQ(turn.kind, Plan::Kind::kLook);
  ASSERT_EQ(turn.T_WBs.size(), 1U);
  EXPECT_EQ(turn.T_WBs[0].translation(), kLookingBack.translation());
  EXPECT_GT(turn.T_WBs[0].linear()(0, 0), 0.9);
  EXPECT_FALSE(explorer.chosen_path_W().empty());
  const std::vector<Eigen::Vector3d> path_W = explorer.chosen_path_W();

  explorer.Arrived(kStart + 1s);
  const Plan go = explorer.MakePlan(turn.T_WBs[0], kStart + 1s);
  ASSERT_EQ(go.kind, Plan::Kind::kGo);
  EXPECT_EQ(explorer.chosen_path_W(), path_W) << "it does not choose again";
  EXPECT_LT((go.T_WBs.front().translation() - kLookingBack.translation()).norm(), 1e-9);
  EXPECT_GT(go.T_WBs.back().translation().x(), 3.5);
  EXPECT_TRUE(explorer.status().set_aside.empty()) << "a turn alone says nothing about the frontier";
}

TEST_P(ExplorerTest, ARobotThatDoesNotFaceTheNarrowPassageStops) {
  Explorer explorer = With(options_, RoomBehindAHole());
  const Plan turn = explorer.MakePlan(kLookingBack, kStart);
  ASSERT_EQ(turn.kind, Plan::Kind::kLook);
  explorer.Arrived(kStart + 1s);
  ASSERT_EQ(explorer.MakePlan(turn.T_WBs[0], kStart + 1s).kind, Plan::Kind::kGo);
  RigidTransform T_WB = turn.T_WBs[0];
  T_WB.translation().x() += 0.2;
  EXPECT_FALSE(explorer.CheckPlan(T_WB).has_value());
  T_WB.linear() = kLookingBack.linear();
  const auto interruption = explorer.CheckPlan(T_WB);
  ASSERT_TRUE(interruption.has_value());
  EXPECT_EQ(*interruption, Interruption::kNotFacingPassage);
  EXPECT_TRUE(IsUnsafe(*interruption));
  EXPECT_EQ(explorer.MakePlan(T_WB, kStart + 2s).kind, Plan::Kind::kLook) << "it turns to it";
}

TEST_P(ExplorerTest, APathThatProvesClosedAfterTheTurnIsNotTaken) {
  options_.loop.wait_at_shut_ways = false;
  Explorer explorer = With(options_, RoomBehindAHole());
  const Plan turn = explorer.MakePlan(kLookingBack, kStart);
  ASSERT_EQ(turn.kind, Plan::Kind::kLook);
  explorer.Update(test::BoxOf({{30, 5, 5}, {31, 8, 8}}, VoxelState::kOccupied), {}, kStart);
  explorer.Arrived(kStart + 1s);
  EXPECT_EQ(explorer.MakePlan(turn.T_WBs[0], kStart + 1s).kind, Plan::Kind::kDone);
}

TEST_P(ExplorerTest, LooksAroundBeforeItGoes) {
  options_.look_around_min_area = 0.2;
  Explorer explorer = With(options_, test::LongRoom());
  const RigidTransform at_the_end = test::At(5.55, 0.65, 0.65);
  const Plan plan = explorer.MakePlan(at_the_end, kStart);
  ASSERT_EQ(plan.kind, Plan::Kind::kLook);
  ASSERT_EQ(plan.T_WBs.size(), 1U);
  EXPECT_EQ(plan.T_WBs.front().translation(), at_the_end.translation());
  EXPECT_GT(plan.T_WBs.front().linear()(0, 0), 0.5);
}

TEST_P(ExplorerTest, ARobotThatDrivesStaysInItsPlaneAndTurnsAboutTheVerticalOnly) {
  options_.robot.height = 0.4;
  options_.robot.drives = true;
  Explorer explorer = With(options_, test::LongRoom());
  const RigidTransform here = test::At(0.55, 0.65, 0.38);
  const Plan plan = explorer.MakePlan(here, kStart);
  ASSERT_EQ(plan.kind, Plan::Kind::kGo);
  EXPECT_GT(plan.T_WBs.back().translation().x(), 4.5);
  for (const RigidTransform& T_WB : plan.T_WBs) {
    EXPECT_NEAR(T_WB.translation().z(), 0.38, 1e-12);
    EXPECT_NEAR(T_WB.linear()(2, 2), 1.0, 1e-12);
  }
  // From 0.18 to 0.58 m, five layers of twelve voxels each must be seen.
  EXPECT_EQ(explorer.status().frontier_voxels_left, 60U);
  // Odometry that drifts upward does not lift the robot.
  EXPECT_FALSE(explorer.CheckPlan(test::At(0.6, 0.65, 0.44)));
  const Plan later = explorer.MakePlan(test::At(0.6, 0.65, 0.44), kStart + 1s);
  ASSERT_EQ(later.kind, Plan::Kind::kGo);
  EXPECT_NEAR(later.T_WBs.front().translation().z(), 0.38, 1e-12);
}

TEST_P(ExplorerTest, ForARobotThatDrivesOnlyWhatItsBodySweepsIsInItsWay) {
  options_.robot.height = 0.4;
  options_.robot.drives = true;
  const RigidTransform here = test::At(0.55, 0.65, 0.38);
  for (const auto& [bottom, top, passable] :
       {std::tuple{6, 12, true}, {5, 12, false}, {0, 1, true}, {0, 2, false}}) {
    std::vector<VoxelChange> changes = test::LongRoom();
    for (const VoxelChange& change : test::BoxOf({{30, 0, bottom}, {31, 12, top}}, VoxelState::kOccupied)) {
      changes.push_back(change);
    }
    Explorer explorer = With(options_, changes);
    const Plan plan = explorer.MakePlan(here, kStart);
    const bool goes = plan.kind == Plan::Kind::kGo && plan.T_WBs.back().translation().x() > 3.1;
    EXPECT_EQ(goes, passable) << bottom << " to " << top;
  }
}

TEST_P(ExplorerTest, ARobotThatDrivesLooksWithItsCameraOverWhatStopsIt) {
  // A wall 0.7 m high at x = 4 m; the end of the room, 1.9 m behind it, is still to be seen.
  options_.look_range = 3.0;
  options_.sensor_range = 3.0;
  options_.robot.height = 0.4;
  options_.robot.drives = true;
  std::vector<VoxelChange> changes = test::LongRoom();
  test::Fill(changes, {{40, 0, 0}, {41, 12, 7}}, VoxelState::kOccupied);
  const RigidTransform here = test::At(0.55, 0.65, 0.38);
  for (const double camera_height : {0.0, 0.55}) {
    options_.robot.T_BC.translation().z() = camera_height;
    Explorer explorer = With(options_, changes);
    const Plan plan = explorer.MakePlan(here, kStart);
    if (camera_height == 0.0) {
      EXPECT_EQ(plan.kind, Plan::Kind::kDone);
    } else {
      ASSERT_EQ(plan.kind, Plan::Kind::kGo);
      EXPECT_GT(plan.T_WBs.back().translation().x(), 2.5);
      EXPECT_LT(plan.T_WBs.back().translation().x(), 3.9);
    }
  }
}

TEST(Explorer, ARobotThatDrivesNeedsAHeight) {
  Explorer::Options options;
  options.robot.drives = true;
  EXPECT_THROW(Explorer{options}, std::invalid_argument);
  options.robot.height = 0.4;
  EXPECT_NO_THROW(Explorer{options});
  options.robot.drive = Drive::kAckermann;
  EXPECT_THROW(Explorer{options}, std::invalid_argument) << "and a turning radius";
}

TEST_P(ExplorerTest, TheTimeBudgetEndsIt) {
  options_.time_budget = 60s;
  Explorer explorer = With(options_, test::LongRoom());
  EXPECT_EQ(explorer.MakePlan(kHere, kStart).kind, Plan::Kind::kGo);
  EXPECT_EQ(explorer.MakePlan(kHere, kStart + 59s).kind, Plan::Kind::kGo);
  EXPECT_EQ(test::EndOf(explorer.MakePlan(kHere, kStart + 60s)), Outcome::kTimeBudget);
}

TEST_P(ExplorerTest, TheDistanceBudgetEndsIt) {
  options_.distance_budget = 2.0;
  Explorer explorer = With(options_, test::LongRoom());
  explorer.Move(test::At(0.5, 0.6, 0.6));
  explorer.Move(test::At(1.5, 0.6, 0.6));
  EXPECT_EQ(explorer.MakePlan(kHere, kStart).kind, Plan::Kind::kGo);
  explorer.Move(test::At(0.4, 0.6, 0.6));
  EXPECT_NEAR(explorer.status().distance, 2.1, 1e-12);
  EXPECT_EQ(test::EndOf(explorer.MakePlan(kHere, kStart)), Outcome::kDistanceBudget);
}

TEST_P(ExplorerTest, AnObstacleOnThePathIsReportedAndOneBesideItIsNot) {
  Explorer explorer = With(options_, test::LongRoom());
  const Plan plan = explorer.MakePlan(kHere, kStart);
  ASSERT_EQ(plan.kind, Plan::Kind::kGo);
  EXPECT_FALSE(explorer.CheckPlan(kHere));
  explorer.Update(test::ObstacleAt({0.05, 0.05, 0.05}), {}, kStart);
  EXPECT_FALSE(explorer.CheckPlan(kHere));
  explorer.Update(test::ObstacleAt(test::PointAlong(plan.T_WBs, 0.5)), {}, kStart);
  const auto why = explorer.CheckPlan(kHere);
  ASSERT_TRUE(why);
  EXPECT_EQ(*why, Interruption::kPathBlocked);
  EXPECT_TRUE(IsUnsafe(*why));
  // A robot that has passed it continues.
  RigidTransform past = kHere;
  past.translation() = test::PointAlong(plan.T_WBs, 0.9);
  EXPECT_FALSE(explorer.CheckPlan(past));
}

TEST_P(ExplorerTest, ATargetThatBecameKnownOnTheWayIsReportedWithoutAlarm) {
  Explorer explorer = With(options_, test::LongRoom());
  ASSERT_EQ(explorer.MakePlan(kHere, kStart).kind, Plan::Kind::kGo);
  explorer.Update(test::FarWall(), {}, kStart);
  const auto why = explorer.CheckPlan(kHere);
  ASSERT_TRUE(why);
  EXPECT_EQ(*why, Interruption::kTargetSeen);
  EXPECT_FALSE(IsUnsafe(*why));
  EXPECT_EQ(test::EndOf(explorer.MakePlan(kHere, kStart)), Outcome::kComplete);
}

/// Goes to the first candidate; weighs looks where time counts.
class Weighing final : public Strategy {
 public:
  Choice Choose(const Situation& situation) override { return StraightTo(situation, 0); }
  bool weighs_looks() const override { return true; }
};

TEST(Explorer, LeavesLooksToAStrategyThatWeighsThemOnlyWhereTimeCounts) {
  for (const Minimize minimize : {Minimize::kPath, Minimize::kTime}) {
    Explorer::Options options = test::GoingOptions();
    options.look_around_min_area = 0.2;
    options.minimize = minimize;
    options.strategy = {"weighing", [] { return std::make_unique<Weighing>(); }};
    Explorer explorer(options);
    explorer.Update(test::LongRoom(), {}, kStart);
    const RigidTransform before_the_end = test::At(5.55, 0.65, 0.65);
    Explorer starting(options);
    starting.Update(test::LongRoom(), {}, kStart);
    EXPECT_EQ(starting.MakePlan(before_the_end, kStart).purpose, Purpose::kLookAround);
    ASSERT_EQ(explorer.MakePlan(kHere, kStart).kind, Plan::Kind::kGo);
    const Purpose purpose = explorer.MakePlan(before_the_end, kStart).purpose;
    EXPECT_EQ(purpose, minimize == Minimize::kTime ? Purpose::kSeeFrontier : Purpose::kLookAround);
  }
}

TEST_P(ExplorerTest, ResetForgetsTheMapAndWhatWasSetAside) {
  Explorer explorer = With(options_, test::LongRoom());
  ASSERT_EQ(explorer.MakePlan(kHere, kStart).kind, Plan::Kind::kGo);
  explorer.Arrived(kStart);
  EXPECT_FALSE(explorer.memory().SetAsideVoxels().empty());
  explorer.Reset();
  EXPECT_TRUE(explorer.memory().SetAsideVoxels().empty());
  EXPECT_FALSE(explorer.KnowsPlace(kHere));
  EXPECT_FALSE(explorer.CheckPlan(kHere));
  explorer.Update(test::LongRoom(), {}, kStart);
  EXPECT_TRUE(explorer.KnowsPlace(kHere));
  EXPECT_EQ(explorer.MakePlan(kHere, kStart).kind, Plan::Kind::kGo);
}

TEST(Explorer, BadOptionsAreRefused) {
  Explorer::Options options;
  options.look_range = 0.0;
  EXPECT_THROW(Explorer{options}, std::invalid_argument);
  options = {};
  options.frontier.min_area = -1.0;
  EXPECT_THROW(Explorer{options}, std::invalid_argument);
  options = {};
  options.frontier.extent = 0.0;
  EXPECT_THROW(Explorer{options}, std::invalid_argument);
  options = {};
  options.memory.looks = 0;
  EXPECT_THROW(Explorer{options}, std::invalid_argument);
  for (const double share : {-0.1, 1.1, std::nan("")}) {
    options = {};
    options.min_measured_share = share;
    EXPECT_THROW(Explorer{options}, std::invalid_argument) << share;
  }
}

}  // namespace
}  // namespace thalweg::explorer
