#include "services/explorer/core/target_chooser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "tests/services/explorer/support/choosing_robot.h"

namespace thalweg::explorer {
namespace {

using std::chrono_literals::operator""s;
using test::ChoosingRobot;
using test::kHere;
using test::kStart;
using test::Orders;
using test::TargetChooserTest;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// What a strategy does.

/// A hall with 1.5 m of space on all sides of its axis.
constexpr VoxelBox kHighHall{{0, 0, 0}, {60, 30, 30}};

/// A room of 4.4 x 1.2 x 1.2 m of which all is known, but for so many voxels of the wall at its far end. Its
/// walls have 4 * 44 * 12 + 2 * 12 * 12 = 2400 voxels.
std::vector<VoxelChange> RoomWithUnseen(std::size_t voxels) {
  std::vector<VoxelChange> changes = test::LongRoom({{0, 0, 0}, {44, 12, 12}});
  std::size_t left = voxels;
  test::ForEachVoxel({{44, 0, 0}, {45, 12, 12}}, [&](const VoxelIndex& i) {
    if (left > 0) {
      --left;
    } else {
      changes.push_back({i, test::kOccupiedLogOdds});
    }
  });
  return changes;
}

constexpr VoxelBox kHoleInASide{{20, 12, 5}, {26, 13, 8}};
constexpr VoxelBox kHoleInTheFloor{{20, 5, -1}, {26, 8, 0}};

/// The long room with a hole, much nearer than the far end.
std::vector<VoxelChange> RoomWithAHole(const VoxelBox& hole = kHoleInASide) {
  std::vector<VoxelChange> changes = test::LongRoom();
  std::erase_if(changes, [&](const VoxelChange& change) { return hole.Contains(change.voxel); });
  return changes;
}

/// The long room with a closed cell of 0.4 m in it, around `kInTheCell`.
std::vector<VoxelChange> RoomWithACell() {
  std::vector<VoxelChange> changes = test::LongRoom();
  for (const VoxelChange& change : test::ClosedRoom({{4, 4, 4}, {8, 8, 8}})) changes.push_back(change);
  return changes;
}
const RigidTransform kInTheCell = test::At(0.6, 0.6, 0.6);

TEST_F(TargetChooserTest, GoesWhereTheStrategySays) {
  std::vector<Eigen::Vector3d> path_W;
  Order({.choose = [&](const Situation& situation) {
    const Choice choice = StraightTo(situation, 1);
    path_W = choice.path_W;
    return choice;
  }});
  ChoosingRobot robot(options_, RoomWithAHole());
  const Task task = robot.Choose();
  EXPECT_EQ(task.plan.kind, Plan::Kind::kGo);
  EXPECT_EQ(task.plan.purpose, Purpose::kSeeFrontier);
  ASSERT_GE(robot.chooser.search().candidates().size(), 2U);
  EXPECT_EQ(task.plan.frontiers, robot.chooser.search().candidates().size());
  EXPECT_EQ(task.plan.target_W, robot.chooser.search().candidates()[1].cluster.center_W);
  EXPECT_EQ(task.choice.path_W, path_W);
  EXPECT_EQ(robot.timings["choice"].Summarize().count, 1U);
}

TEST_F(TargetChooserTest, WithNothingLeftTheEndIsComplete) {
  ChoosingRobot robot(options_, test::ClosedRoom(test::kLongRoom));
  const Task task = robot.Choose();
  EXPECT_EQ(test::EndOf(task.plan), Outcome::kComplete);
  EXPECT_THAT(task.plan.T_WBs, IsEmpty());
  EXPECT_THAT(robot.chooser.search().candidates(), IsEmpty());
  EXPECT_THAT(task.plan.ending->missed, IsEmpty());
}

TEST_F(TargetChooserTest, ARobotThatIsShutInSaysWhy) {
  ChoosingRobot robot(options_, RoomWithACell(), kInTheCell);
  const Task task = robot.Choose();
  ASSERT_EQ(test::EndOf(task.plan), Outcome::kNothingReachable);
  ASSERT_TRUE(task.plan.ending->shut_in);
  EXPECT_EQ(task.plan.ending->shut_in->radius, options_.robot.radius);
  EXPECT_NEAR(task.plan.ending->shut_in->needed, 0.15, 1e-12);
  EXPECT_FALSE(task.plan.ending->shut_in->fitting) << "the cell is closed";
}

TEST_F(TargetChooserTest, EndsByTheBudgetThatAllowsNothingThatIsLeft) {
  options_.return_home = true;
  ChoosingRobot free(options_, test::LongRoom());
  ASSERT_EQ(free.Choose().plan.kind, Plan::Kind::kGo);
  double nearest = std::numeric_limits<double>::infinity();
  for (const Candidate& candidate : free.chooser.search().candidates())
    nearest = std::min(nearest, candidate.length);
  const double home = (1.0 + options_.home_margin) * nearest + HomePaths::Options{}.reserve;
  const double half_turn = std::numbers::pi / options_.robot.max_turn_rate;  // [s]
  const double seconds = (nearest + home) / options_.robot.max_speed + 2.0 * half_turn;
  for (const bool enough : {true, false}) {
    // Lengths are known to some hundredths of a meter.
    options_.distance_budget = nearest + home + (enough ? 0.2 : -0.2);
    options_.time_budget = Duration::zero();
    ChoosingRobot far_going(options_, test::LongRoom());
    EXPECT_EQ(test::EndOf(far_going.Choose().plan),
              enough ? std::nullopt : std::optional(Outcome::kDistanceBudget));
    options_.distance_budget = 0.0;
    options_.time_budget = 100s;
    ChoosingRobot enduring(options_, test::LongRoom());
    const Time now = kStart + 100s - FromSeconds(seconds + (enough ? 0.5 : -0.5));
    EXPECT_EQ(test::EndOf(enduring.Choose(now).plan),
              enough ? std::nullopt : std::optional(Outcome::kTimeBudget));
    EXPECT_EQ(enduring.chooser.search().candidates().empty(), !enough);
  }
}

TEST_F(TargetChooserTest, WhatIsNotWorthItsPathIsLeftUpToAHundredthOfTheBorder) {
  Order({});
  ChoosingRobot content(options_, RoomWithUnseen(24));
  const Task end = content.Choose();
  ASSERT_EQ(test::EndOf(end.plan), Outcome::kComplete);
  EXPECT_NEAR(end.plan.ending->left_area, 0.24, 1e-9);
  EXPECT_GE(end.plan.ending->left_frontiers, 1U);
  ChoosingRobot restless(options_, RoomWithUnseen(25));
  const Task task = restless.Choose();
  EXPECT_EQ(task.plan.kind, Plan::Kind::kGo);
  EXPECT_FALSE(task.plan.ending);
}

TEST_F(TargetChooserTest, WhatWasOutOfSightIsTriedAgainBeforeNothingIsWorthItsPath) {
  // The strategy goes to the hole in the side wall and nowhere else.
  Order({.choose = [](const Situation& situation) {
    for (std::size_t n = 0; n < situation.candidates.size(); ++n) {
      if (situation.candidates[n].cluster.center_W.y() > 1.2) return StraightTo(situation, n);
    }
    return Choice{};
  }});
  std::vector<VoxelChange> changes = RoomWithUnseen(24);
  const VoxelBox hole{{20, 12, 5}, {26, 13, 8}};
  std::erase_if(changes, [&](const VoxelChange& change) { return hole.Contains(change.voxel); });
  ChoosingRobot robot(options_, changes);
  test::ForEachVoxel(hole, [&](const VoxelIndex& i) {
    robot.knowledge.memory().SetAside(i, AsideReason::kOutOfSight, kStart);
  });
  const Task task = robot.Choose();
  ASSERT_EQ(task.plan.kind, Plan::Kind::kGo);
  EXPECT_FALSE(task.plan.ending);
  EXPECT_EQ(task.plan.target_unknown, 6U * 3U) << "it is in sight now";
}

TEST_F(TargetChooserTest, WhatIsInSightAgainIsOfferedToTheStrategyOnce) {
  std::vector<std::size_t> offered;
  Order({.choose = [&](const Situation& situation) {
    offered.push_back(situation.candidates.size());
    return Choice{};
  }});
  ChoosingRobot robot(options_, RoomWithUnseen(24));
  test::ForEachVoxel({{44, 0, 0}, {45, 1, 6}}, [&](const VoxelIndex& i) {
    robot.knowledge.memory().SetAside(i, AsideReason::kOutOfSight, kStart);
  });
  const Task end = robot.Choose();
  EXPECT_EQ(test::EndOf(end.plan), Outcome::kComplete);
  ASSERT_THAT(offered, SizeIs(2));
  EXPECT_NEAR(end.plan.ending->left_area, 0.24, 1e-9) << "with what is in sight again";
}

/// Sets the near side of a bar at `x` [voxels] aside.
void GiveUpOnBar(int x, AsideReason reason, ChoosingRobot& robot) {
  test::ForEachVoxel({{x, 0, 0}, {x + 1, 12, 12}},
                     [&](const VoxelIndex& i) { robot.knowledge.memory().SetAside(i, reason, kStart); });
}

TEST_F(TargetChooserTest, WhatBarsThePathToTheRestIsLookedAtAgainAsOftenAsItHasChances) {
  options_.max_missed_share = 0.1;  // the bar's near side is 0.04 of the border, and all that is open 0.13
  Order({});
  // Less and more than half of the space is behind it.
  for (const auto& [x, reason] :
       {std::pair(36, AsideReason::kVisited), std::pair(20, AsideReason::kNoDepth)}) {
    ChoosingRobot robot(options_, test::RoomWithABar(x));
    for (int chance = 0; chance < LookMemory::Options{}.chances; ++chance) {
      GiveUpOnBar(x, reason, robot);
      const Task task = robot.Choose();
      ASSERT_EQ(task.plan.kind, Plan::Kind::kGo) << x << ' ' << chance;
      EXPECT_EQ(task.plan.purpose, Purpose::kSeeFrontier);
      ASSERT_TRUE(task.plan.target_W);
      EXPECT_NEAR(task.plan.target_W->x(), 0.1 * x + 0.05, 1e-9);
      EXPECT_NEAR(task.plan.T_WBs.back().translation().x(), 0.1 * x - 0.3, 0.2) << "from as near as can be";
    }
    GiveUpOnBar(x, reason, robot);
    const Task task = robot.Choose();
    EXPECT_EQ(test::EndOf(task.plan), x > 30 ? Outcome::kTooMuchUnknown : Outcome::kNothingReachable);
    if (x > 30) {
      EXPECT_NEAR(task.plan.ending->hidden_area, 2.88, 1e-9);
    }
  }
}

TEST_F(TargetChooserTest, WhenMuchIsLeftThatIsNotWorthItsPathTheNearestIsNext) {
  Order({});
  for (const VoxelBox& hole : {kHoleInASide, kHoleInTheFloor}) {
    ChoosingRobot robot(options_, RoomWithAHole(hole));
    const Task task = robot.Choose();
    ASSERT_EQ(task.plan.kind, Plan::Kind::kGo);
    ASSERT_TRUE(task.plan.target_W);
    const VoxelIndex corners = hole.min + hole.max;
    const Eigen::Vector3d middle_W = 0.05 * Eigen::Vector3d(corners.x, corners.y, corners.z);
    EXPECT_LT((*task.plan.target_W - middle_W).norm(), 1e-9) << "the hole, not the far end";
    EXPECT_EQ(task.plan.target_unknown, 6U * 3U);
  }
}

TEST_F(TargetChooserTest, ABudgetEndsItWhereNothingThatItAllowsIsWorthItsPath) {
  Order({});
  options_.return_home = true;
  options_.distance_budget = 8.0;  // for the hole, not for the far end
  ChoosingRobot robot(options_, RoomWithAHole());
  EXPECT_EQ(test::EndOf(robot.Choose().plan), Outcome::kDistanceBudget);
  EXPECT_THAT(robot.chooser.search().candidates(), SizeIs(1));
}

TEST_F(TargetChooserTest, ADetourThatABudgetForbidsGivesWayToTheStraightPath) {
  constexpr VoxelBox kWide{{0, 0, 0}, {60, 30, 12}};
  options_.loop.stop_short = false;
  options_.comfort.distance = 0.0;  // paths as the strategy chooses them
  options_.return_home = true;
  Choice detour;
  double direct = 0.0;  // [m]
  Order({.choose = [&](const Situation& situation) {
    const std::size_t nearest = NearestCandidate(situation);
    const Eigen::Vector3d goal_W = situation.map.CenterOf(situation.candidates[nearest].goals.front());
    direct = (goal_W - situation.robot_W).norm();
    detour = {.candidate = nearest,
              .path_W = {situation.robot_W, {0.55, 2.65, 0.65}, {goal_W.x(), 2.65, 0.65}, goal_W}};
    return detour;
  }});
  ChoosingRobot free(options_, test::LongRoom(kWide));
  const Task round = free.Choose();
  EXPECT_NEAR(round.plan.length, PathLength(detour.path_W), 1e-9);
  EXPECT_EQ(round.choice.path_W, detour.path_W);
  ASSERT_GT(round.plan.length, direct + 2.0);

  options_.distance_budget = direct + (1.0 + options_.home_margin) * direct + 0.5 + 1.0;
  ChoosingRobot bound(options_, test::LongRoom(kWide));
  const Task straight = bound.Choose();
  ASSERT_EQ(straight.plan.kind, Plan::Kind::kGo);
  EXPECT_NEAR(straight.plan.length, direct, 0.01);
  EXPECT_EQ(straight.choice.candidate, detour.candidate);
  EXPECT_LT((straight.plan.T_WBs.back().translation() - detour.path_W.back()).norm(), 1e-9);
}

TEST_F(TargetChooserTest, AnUnknownStrategyIsAnErrorAndLeavesTheOldOneInPlace) {
  options_.strategy = Configure("surface");
  ChoosingRobot robot(options_, test::LongRoom());
  const Strategy* const before = &robot.chooser.strategy();
  ASSERT_NE(robot.knowledge.inspected(), nullptr);
  const std::optional<Error> error = robot.chooser.UseStrategy("clairvoyance", robot.knowledge);
  ASSERT_TRUE(error);
  EXPECT_THAT(error->text, HasSubstr("'clairvoyance' is unknown"));
  EXPECT_EQ(robot.chooser.strategy_name(), "surface");
  EXPECT_EQ(&robot.chooser.strategy(), before);
  EXPECT_NE(robot.knowledge.inspected(), nullptr);
}

TEST_F(TargetChooserTest, AStrategyThatRefusesItsOptionsLeavesTheOldOneInPlace) {
  options_.configure = [](std::string_view name) -> ConfiguredStrategy {
    return {std::string(name),
            []() -> std::unique_ptr<Strategy> { throw std::invalid_argument("patience must be > 0"); }};
  };
  ChoosingRobot robot(options_, test::LongRoom());
  const Strategy* const before = &robot.chooser.strategy();
  const std::optional<Error> error = robot.chooser.UseStrategy("flow", robot.knowledge);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->text, "patience must be > 0");
  EXPECT_EQ(robot.chooser.strategy_name(), "closest");
  EXPECT_EQ(&robot.chooser.strategy(), before);
}

TEST_F(TargetChooserTest, AStrategyForRobotsThatDriveIsRefusedToOthers) {
  ChoosingRobot robot(options_, test::LongRoom());
  const std::optional<Error> error = robot.chooser.UseStrategy("gaps", robot.knowledge);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->text, "the strategy gaps is for a robot that drives, and robot.drives is false");
  EXPECT_EQ(robot.chooser.strategy_name(), "closest");
  options_.strategy = Configure("gaps");
  EXPECT_THROW(TargetChooser(options_, robot.knowledge), std::invalid_argument);
  options_.robot.drives = true;
  EXPECT_NO_THROW(TargetChooser(options_, robot.knowledge));
}

TEST_F(TargetChooserTest, WhatThereIsNoRoomToTurnToIsSetAsideUntilTheRobotIsElsewhereAndNamedAtTheEnd) {
  options_.robot.drives = true;
  options_.robot.height = 0.4;
  options_.robot.drive = Drive::kAckermann;
  options_.robot.min_turning_radius = 50.0;
  Order({.choose = [](const Situation& situation) {
    // The hole, across the room, before what lies straight ahead.
    const Eigen::Vector3d here_W = situation.robot_W;
    for (std::size_t n = 0; n < situation.candidates.size(); ++n) {
      if (situation.candidates[n].cluster.center_W.y() > 1.1)
        return Choice{.candidate = n,
                      .path_W = {here_W, {2.25, here_W.y(), here_W.z()}},
                      .R_WB = RotationFromYawPitch(0.5 * std::numbers::pi, 0.0)};
    }
    return Choice{.path_W = {here_W, {5.05, here_W.y(), here_W.z()}}, .R_WB = Eigen::Matrix3d::Identity()};
  }});
  ChoosingRobot robot(options_, RoomWithAHole());
  robot.T_WB = robot.knowledge.InPlane(kHere);
  const Task task = robot.Choose();
  ASSERT_EQ(task.plan.kind, Plan::Kind::kGo);
  EXPECT_GT(task.plan.T_WBs.back().translation().x(), 4.0) << "straight on, where it faces";
  const LookMemory& memory = robot.knowledge.memory();
  const std::size_t without_room = memory.Count(AsideReason::kNoRoom);
  EXPECT_GT(without_room, 0U);
  EXPECT_EQ(memory.set_aside()[kHoleInASide.min], static_cast<std::uint8_t>(AsideReason::kNoRoom));
  // At the far end, of which all is known then, it tries again, and again in vain.
  robot.knowledge.Update(test::FarWall(), {}, kStart + 1s);
  robot.T_WB = task.plan.T_WBs.back();
  const Task end = robot.Choose(kStart + 1s);
  ASSERT_TRUE(end.plan.ending);
  EXPECT_EQ(memory.Count(AsideReason::kNoRoom), without_room);
  const auto& missed = end.plan.ending->missed;
  EXPECT_TRUE(
      std::ranges::any_of(missed, [](const auto& part) { return part.reason == AsideReason::kNoRoom; }));
  // One that can turn tighter goes there after all.
  options_.robot.min_turning_radius = 0.3;
  ChoosingRobot nimble(options_, RoomWithAHole());
  nimble.T_WB = nimble.knowledge.InPlane(kHere);
  EXPECT_LT(nimble.Choose().plan.T_WBs.back().translation().x(), 4.0);
}

TEST_F(TargetChooserTest, WithoutRoomForAnythingItEndsAlthoughNothingIsSetAside) {
  options_.robot.drives = true;
  options_.robot.height = 0.4;
  options_.robot.drive = Drive::kAckermann;
  options_.robot.min_turning_radius = 50.0;
  options_.memory.sets_aside = false;
  std::vector<VoxelChange> changes = RoomWithAHole();
  for (const VoxelChange& change : test::FarWall()) changes.push_back(change);
  ChoosingRobot robot(options_, changes);
  robot.T_WB = robot.knowledge.InPlane(kHere);
  EXPECT_TRUE(robot.Choose().plan.ending);
}

TEST_F(TargetChooserTest, AStrategyThatDoesNotApplyEndsItWhateverIsLeft) {
  const Eigen::Vector3d pillar(2.0, 0.6, 0.6);
  Order({.misfit_W = pillar});
  for (const std::vector<VoxelChange>& room : {test::LongRoom(), test::ClosedRoom(test::kLongRoom)}) {
    ChoosingRobot robot(options_, room);
    const Task task = robot.Choose();
    EXPECT_EQ(test::EndOf(task.plan), Outcome::kDoesNotApply);
    EXPECT_EQ(task.plan.ending->misfit_W, pillar);
    EXPECT_FALSE(task.plan.ending->succeeded());
  }
}

TEST_F(TargetChooserTest, GoesByViewsOnlyIfItBeganSo) {
  Order({});
  ChoosingRobot without(options_, test::LongRoom());
  const std::optional<Error> error = without.chooser.UseStrategy("rift", without.knowledge);
  ASSERT_TRUE(error);
  EXPECT_THAT(error->text, HasSubstr("the strategy rift goes by views of the camera"));
  EXPECT_EQ(without.chooser.strategy_name(), "obedient");
  options_.strategy = Configure("rift");
  ChoosingRobot with(options_, test::LongRoom());
  EXPECT_FALSE(with.chooser.UseStrategy("closest", with.knowledge));
  EXPECT_FALSE(with.chooser.UseStrategy("rift", with.knowledge));
  EXPECT_TRUE(with.chooser.strategy().goes_by_views());
}

TEST_F(TargetChooserTest, AStrategyForRobotsThatLookAnywhereRefusesOthers) {
  Order({});
  ChoosingRobot robot(options_, test::LongRoom());
  options_.robot.attitude = Attitude::kLevel;
  options_.strategy = Configure("rift");
  EXPECT_THROW(TargetChooser(options_, robot.knowledge), std::invalid_argument);
}

TEST_F(TargetChooserTest, ChoosesByAnotherStrategyFromThenOn) {
  Order({});
  ChoosingRobot robot(options_, RoomWithUnseen(24));
  EXPECT_TRUE(robot.Choose().plan.ending);
  EXPECT_FALSE(robot.chooser.UseStrategy("closest", robot.knowledge));
  EXPECT_EQ(robot.chooser.strategy_name(), "closest");
  EXPECT_EQ(robot.Choose().plan.kind, Plan::Kind::kGo);
  EXPECT_EQ(robot.knowledge.inspected(), nullptr);
  EXPECT_FALSE(robot.chooser.UseStrategy("surface", robot.knowledge));
  EXPECT_NE(robot.knowledge.inspected(), nullptr) << "it wants surface inspected";
  EXPECT_FALSE(robot.chooser.UseStrategy("closest", robot.knowledge));
  EXPECT_EQ(robot.knowledge.inspected(), nullptr);
}

TEST_F(TargetChooserTest, TakesOverTheStrategyOfAnotherAsAnInstanceOfItsOwn) {
  ChoosingRobot robot(options_, RoomWithUnseen(24));
  Order({});
  ChoosingRobot other(options_, RoomWithUnseen(24));
  robot.chooser.TakeOverFrom(other.chooser, robot.knowledge);
  EXPECT_EQ(robot.chooser.strategy_name(), "obedient");
  EXPECT_NE(&robot.chooser.strategy(), &other.chooser.strategy());
  EXPECT_TRUE(robot.Choose().plan.ending) << "it finds nothing worth its path any more";
}

TEST_F(TargetChooserTest, InspectsWhatATurnShowsBeforeItGoesToAFrontier) {
  Order({.choose = [](const Situation& situation) { return StraightTo(situation, 0); },
         .inspection = InspectionOptions{.criterion = {}, .min_area = 0.2}});
  ChoosingRobot robot(options_, test::LongRoom());
  const Task task = robot.Choose();
  EXPECT_EQ(task.plan.purpose, Purpose::kInspect);
  EXPECT_GE(task.plan.inspects, 0.2);
  EXPECT_EQ(task.plan.frontiers, robot.chooser.search().candidates().size());
  EXPECT_GT(task.plan.frontiers, 0U);
  EXPECT_EQ(robot.timings["inspection"].Summarize().count, 1U);
}

TEST_F(TargetChooserTest, InspectsWhatIsFarAfterAFrontierThatIsNear) {
  // A hall whose walls can be inspected from 0.5 m only, with an unknown block in reach of a look from where
  // the robot stands: in the middle, 1.5 m from all walls. An occupied block has surface of its own.
  const VoxelBox block{{38, 13, 13}, {42, 17, 17}};
  Order({.choose =
             [](const Situation& situation) {
               return Choice{.candidate = 0, .path_W = {situation.robot_W, situation.robot_W}};
             },
         .inspection = InspectionOptions{.criterion = {.distance = 0.5}, .min_area = 0.1}});
  std::vector<VoxelChange> changes = test::ClosedRoom(kHighHall);
  std::erase_if(changes, [&](const VoxelChange& change) { return block.Contains(change.voxel); });
  ChoosingRobot robot(options_, changes, test::At(3.05, 1.55, 1.55));
  const Task task = robot.Choose();
  EXPECT_EQ(task.plan.purpose, Purpose::kSeeFrontier);
  EXPECT_EQ(task.plan.target_unknown, 4U * 4U * 4U - 2U * 2U * 2U) << "its sides";
  ChoosingRobot elsewhere(options_, test::ClosedRoom(kHighHall), test::At(3.05, 1.55, 1.55));
  const Task far = elsewhere.Choose();
  EXPECT_EQ(far.plan.purpose, Purpose::kInspect) << "however far, where no frontier is left";
  EXPECT_GT(far.plan.length, 0.9);
}

TEST_F(TargetChooserTest, ABudgetThatForbidsTheInspectionThatIsLeftEndsIt) {
  Order({.inspection = InspectionOptions{.criterion = {.distance = 0.5}, .min_area = 0.1}});
  options_.return_home = true;
  options_.distance_budget = 1.0;
  ChoosingRobot robot(options_, test::ClosedRoom(kHighHall), test::At(3.05, 1.55, 1.55));
  EXPECT_EQ(test::EndOf(robot.Choose().plan), Outcome::kDistanceBudget);
}

TEST_F(TargetChooserTest, AStrategyThatFindsItsFrontiersItselfEndsItWhenItFindsNone) {
  Order({.own = std::vector<Candidate>{}});
  ChoosingRobot robot(options_, test::LongRoom());
  EXPECT_EQ(test::EndOf(robot.Choose().plan), Outcome::kComplete) << "whatever frontiers others would find";
  ChoosingRobot shut_in(options_, RoomWithACell(), kInTheCell);
  EXPECT_EQ(test::EndOf(shut_in.Choose().plan), Outcome::kComplete) << "nobody has looked for a way out";
}

TEST_F(TargetChooserTest, AStrategyThatFindsItsFrontiersItselfIsShutInWhenItKnowsNoPathToThem) {
  std::vector<Candidate> own(1);
  own[0].cluster = {.unknowns = {{60, 5, 5}}, .center_W = {6.05, 0.55, 0.55}};
  own[0].goals = {{55, 6, 6}};
  for (const bool knows_path : {false, true}) {
    Order({.choose =
               [&](const Situation& situation) {
                 Choice choice{.candidate = 0, .path_W = {situation.robot_W}};
                 if (knows_path) choice.path_W.emplace_back(5.55, 0.65, 0.65);
                 return choice;
               },
           .own = own});
    ChoosingRobot robot(options_, test::LongRoom());
    const Task task = robot.Choose();
    if (knows_path) {
      EXPECT_EQ(task.plan.kind, Plan::Kind::kGo);
      EXPECT_EQ(task.plan.target_W, own[0].cluster.center_W);
      EXPECT_EQ(task.plan.frontiers, 1U);
    } else {
      ASSERT_EQ(test::EndOf(task.plan), Outcome::kNothingReachable);
      EXPECT_TRUE(task.plan.ending->shut_in);
    }
    EXPECT_FALSE(robot.timings.contains("flood")) << "it is not searched for others";
  }
}

TEST_F(TargetChooserTest, TheStrategyKnowsWhereTheRobotIsAndHowFarItSees) {
  options_.sensor_range = 1.7;
  options_.loop.pull_straight = false;
  std::size_t choices = 0;
  Order({.choose = [&](const Situation& situation) {
    ++choices;
    EXPECT_EQ(situation.robot_W, kHere.translation());
    EXPECT_EQ(situation.sensor_range, 1.7);
    EXPECT_EQ(situation.look_range, options_.look_range);
    EXPECT_NEAR(situation.clearance, 0.15, 1e-12);
    EXPECT_FALSE(situation.pull_straight);
    EXPECT_FALSE(situation.candidates.empty());
    return StraightTo(situation, 0);
  }});
  ChoosingRobot(options_, test::LongRoom()).Choose();
  EXPECT_EQ(choices, 1U);
}

TEST_F(TargetChooserTest, TurnsHaveAPriceWhereTimeCounts) {
  const RigidTransform looking_back =
      MakeTransform(RotationFromYawPitch(std::numbers::pi, 0.0), {5.55, 0.65, 0.65});  // right at the far end
  for (const Minimize minimize : {Minimize::kPath, Minimize::kTime}) {
    const bool time = minimize == Minimize::kTime;
    options_.minimize = minimize;
    std::size_t choices = 0;
    Order({.choose = [&](const Situation& situation) {
      ++choices;
      for (const Candidate& candidate : situation.candidates)
        EXPECT_EQ(candidate.turn > 0.0, time) << candidate.cluster.center_W.transpose();
      EXPECT_EQ(situation.time.has_value(), time);
      if (time) {
        EXPECT_EQ(situation.time->R_WB, looking_back.linear());
        EXPECT_EQ(situation.time->model.max_turn_rate, options_.robot.max_turn_rate);
      }
      return StraightTo(situation, 0);
    }});
    ChoosingRobot(options_, test::LongRoom(), looking_back).Choose();
    EXPECT_EQ(choices, 1U);
  }
}

TEST_F(TargetChooserTest, DoesNotLookAgainWhereWhatIsMissedIsLittleEnough) {
  // The near side, the far side and the far end are 3 of 4 * 56 * 12 + 4 * 144 voxels.
  options_.max_missed_share = 1.01 * 3.0 * 144.0 / (4 * 56 * 12 + 4 * 144.0);
  ChoosingRobot robot(options_, test::RoomWithABar(34));
  GiveUpOnBar(34, AsideReason::kVisited, robot);
  EXPECT_EQ(test::EndOf(robot.Choose().plan), Outcome::kComplete);
}

}  // namespace
}  // namespace thalweg::explorer
