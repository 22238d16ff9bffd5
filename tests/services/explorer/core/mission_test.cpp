#include "services/explorer/core/mission.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

using std::chrono_literals::operator""s;

const Eigen::Vector3d kHome_W(0.55, 0.55, 0.55);

PlanningMap OneRoom() {
  PlanningMap map({.voxel_size = 0.1, .clearance = 0.15, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {60, 11, 11}}, VoxelState::kFree));
  return map;
}

TEST(Mission, SumsTheDistanceAndNamesTheBudgetThatIsSpent) {
  Mission mission({.time_budget = 60s, .distance_budget = 3.0, .return_home = false, .home_paths = {}});
  EXPECT_FALSE(mission.Spent(Time(1000s)));
  mission.Move({0, 0, 0});
  mission.Move({1, 0, 0});
  mission.Move({1, 2, 0});
  EXPECT_DOUBLE_EQ(mission.distance(), 3.0);
  EXPECT_EQ(mission.Spent(Time(1001s)), Budget::kDistance);
  EXPECT_EQ(mission.Spent(Time(1060s)), Budget::kTime);
}

TEST(Mission, ATremblingPoseTravelsNowhere) {
  Mission mission({.time_budget = {}, .distance_budget = 0.0, .return_home = false, .home_paths = {}});
  for (int n = 0; n < 1000; ++n) mission.Move({n % 2 == 0 ? 0.001 : -0.001, 0, 0});
  EXPECT_EQ(mission.distance(), 0.0);
  for (int n = 0; n <= 1000; ++n) mission.Move({0.002 * n, 0, 0});
  EXPECT_NEAR(mission.distance(), 2.0, 0.02) << "one that moves slowly";
}

TEST(Mission, AClockThatGoesBackTakesNoTimeFromTheBudget) {
  Mission mission({.time_budget = 60s, .distance_budget = 0.0, .return_home = false, .home_paths = {}});
  EXPECT_FALSE(mission.Spent(Time(1000s)));
  mission.ShiftTimes(900s);
  EXPECT_FALSE(mission.Spent(Time(159s)));
  EXPECT_TRUE(mission.Spent(Time(160s)));
}

TEST(Mission, HomeIsDueWhenNoMoreIsLeftThanThePathNeeds) {
  const PlanningMap map = OneRoom();
  Mission mission({.time_budget = {}, .distance_budget = 6.0, .return_home = true, .home_paths = {}});
  mission.FindPathsHome(map, kHome_W);
  EXPECT_EQ(mission.home_paths().home_W(), kHome_W);
  mission.Move(kHome_W);
  const Eigen::Vector3d far_W = kHome_W + Eigen::Vector3d(2.0, 0, 0);  // home needs 1.15 * 2.0 + 0.5 m
  EXPECT_EQ(mission.TooFar(map, 3.3, far_W, Time(0s)), Budget::kDistance);
  EXPECT_FALSE(mission.TooFar(map, 3.1, far_W, Time(0s)));
  mission.Move(far_W);
  mission.FindPathsHome(map, far_W);
  EXPECT_EQ(mission.home_paths().home_W(), kHome_W) << "the first call was made from home";
  EXPECT_FALSE(mission.HomeIsDue(map, far_W, Time(0s)));
  mission.Move(far_W + Eigen::Vector3d(0, 0, 0.7));
  mission.Move(far_W);
  EXPECT_EQ(mission.HomeIsDue(map, far_W, Time(0s)), Budget::kDistance);
}

TEST(Mission, WhereNoPathHomeIsKnownItGoesBackTheWayItCame) {
  PlanningMap map = OneRoom();
  Mission mission({.time_budget = {}, .distance_budget = 9.2, .return_home = true, .home_paths = {}});
  mission.FindPathsHome(map, kHome_W);
  mission.Move(kHome_W);
  const Eigen::Vector3d far_W = kHome_W + Eigen::Vector3d(2.0, 0, 0);
  mission.Move(far_W);
  mission.FindPathsHome(map, far_W);
  map.Apply(test::BoxOf({{15, 0, 0}, {16, 11, 11}}, VoxelState::kOccupied));
  const Eigen::Vector3d farther_W = far_W + Eigen::Vector3d(1.0, 0, 0);
  mission.Move(farther_W);
  mission.FindPathsHome(map, farther_W);
  ASSERT_FALSE(mission.home_paths().LengthFrom(map, farther_W));
  // 3 m are used, and the way back needs 1.15 * 3 + 0.5 m.
  EXPECT_FALSE(mission.HomeIsDue(map, farther_W, Time(0s)));
  EXPECT_FALSE(mission.TooFar(map, 0.9, farther_W, Time(0s)));
  EXPECT_EQ(mission.TooFar(map, 1.1, farther_W, Time(0s)), Budget::kDistance) << "there and back";
  mission.Move(far_W);
  EXPECT_FALSE(mission.HomeIsDue(map, far_W, Time(0s))) << "4 m, and 1.15 * 4 + 0.5 m";
  mission.Move(farther_W);
  EXPECT_EQ(mission.HomeIsDue(map, farther_W, Time(0s)), Budget::kDistance);
}

TEST(Mission, TimeForThePathHomeIsKeptToo) {
  const PlanningMap map = OneRoom();
  Mission mission({.time_budget = 20s, .distance_budget = 0.0, .return_home = true, .home_paths = {}});
  EXPECT_FALSE(mission.Spent(Time(0s)));
  mission.FindPathsHome(map, kHome_W);
  const Eigen::Vector3d far_W = kHome_W + Eigen::Vector3d(2.0, 0, 0);
  EXPECT_FALSE(mission.HomeIsDue(map, far_W, Time(5s)));
  EXPECT_EQ(mission.HomeIsDue(map, far_W, Time(15s)), Budget::kTime);
}

TEST(Mission, WithoutReturningNoPathHomeIsSearchedAndNoneIsDue) {
  const PlanningMap map = OneRoom();
  Mission mission({.time_budget = {}, .distance_budget = 1.0, .return_home = false, .home_paths = {}});
  mission.FindPathsHome(map, kHome_W);
  EXPECT_FALSE(mission.home_paths().LengthFrom(map, kHome_W));
  EXPECT_FALSE(mission.TooFar(map, 100.0, kHome_W, Time(0s)));
  // Where home is, the robot remembers all the same, since an operator may send it there.
  EXPECT_EQ(mission.home_paths().home_W(), kHome_W);
  EXPECT_TRUE(mission.KnowsPathHome(map, kHome_W + Eigen::Vector3d(1.0, 0, 0)));
}

TEST(Mission, ARobotThatTurnedHomeEndsThereForTheReasonItTurned) {
  const PlanningMap map = OneRoom();
  for (const Outcome why : {Outcome::kComplete, Outcome::kTimeBudget}) {
    Mission mission({.time_budget = {}, .distance_budget = 0.0, .return_home = true, .home_paths = {}});
    mission.FindPathsHome(map, kHome_W);
    EXPECT_FALSE(mission.homeward());
    mission.TurnHome({.outcome = why});
    EXPECT_EQ(mission.homeward(), why);
    EXPECT_FALSE(mission.EndingAtHome(kHome_W + Eigen::Vector3d(0.2, 0, 0)));
    const std::optional<Ending> ending = mission.EndingAtHome(kHome_W + Eigen::Vector3d(0.1, 0, 0));
    ASSERT_TRUE(ending);
    EXPECT_EQ(ending->outcome, why);
    EXPECT_EQ(ending->home_within_budget, why == Outcome::kTimeBudget);
    EXPECT_TRUE(ending->succeeded());
  }
}

TEST(Mission, ABadMarginIsNamed) {
  EXPECT_THROW(
      Mission({.time_budget = {}, .distance_budget = 0, .return_home = true, .home_paths = {.margin = -0.1}}),
      std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::explorer
