#include "services/explorer/core/journey.h"

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

TEST(Journey, SumsUpTheWayAndTellsWhichBudgetIsSpent) {
  Journey journey({.time_budget = 60s, .distance_budget = 3.0, .return_home = false, .way_home = {}});
  EXPECT_FALSE(journey.Spent(Time(1000s)));
  journey.Move({0, 0, 0});
  journey.Move({1, 0, 0});
  journey.Move({1, 2, 0});
  EXPECT_DOUBLE_EQ(journey.distance(), 3.0);
  EXPECT_EQ(journey.Spent(Time(1001s)), "distance budget");
  EXPECT_EQ(journey.Spent(Time(1060s)), "time budget");
  EXPECT_TRUE(Journey::IsBudget("time budget"));
  EXPECT_FALSE(Journey::IsBudget("complete"));
}

TEST(Journey, AClockThatGoesBackTakesNoTimeFromTheBudget) {
  Journey journey({.time_budget = 60s, .distance_budget = 0.0, .return_home = false, .way_home = {}});
  EXPECT_FALSE(journey.Spent(Time(1000s)));
  journey.ShiftTimes(900s);
  EXPECT_FALSE(journey.Spent(Time(159s)));
  EXPECT_TRUE(journey.Spent(Time(160s)));
}

TEST(Journey, HomeIsDueWhenNoMoreIsLeftThanTheWayNeeds) {
  const PlanningMap map = OneRoom();
  Journey journey({.time_budget = {}, .distance_budget = 6.0, .return_home = true, .way_home = {}});
  journey.FindWaysHome(map, kHome_W);
  EXPECT_EQ(journey.way_home().home_W(), kHome_W);
  journey.Move(kHome_W);
  const Eigen::Vector3d far_W = kHome_W + Eigen::Vector3d(2.0, 0, 0);  // home needs 1.15 * 2.0 + 0.5 m
  EXPECT_EQ(journey.TooFar(map, 3.3, far_W, Time(0s)), "distance budget");
  EXPECT_FALSE(journey.TooFar(map, 3.1, far_W, Time(0s)));
  journey.Move(far_W);
  journey.FindWaysHome(map, far_W);
  EXPECT_EQ(journey.way_home().home_W(), kHome_W) << "the first call was made from home";
  EXPECT_FALSE(journey.HomeIsDue(map, far_W, Time(0s)));
  journey.Move(far_W + Eigen::Vector3d(0, 0, 0.7));
  journey.Move(far_W);
  EXPECT_EQ(journey.HomeIsDue(map, far_W, Time(0s)), "distance budget");
}

TEST(Journey, TimeForTheWayHomeIsKeptToo) {
  const PlanningMap map = OneRoom();
  Journey journey({.time_budget = 20s, .distance_budget = 0.0, .return_home = true, .way_home = {}});
  EXPECT_FALSE(journey.Spent(Time(0s)));
  journey.FindWaysHome(map, kHome_W);
  const Eigen::Vector3d far_W = kHome_W + Eigen::Vector3d(2.0, 0, 0);
  EXPECT_FALSE(journey.HomeIsDue(map, far_W, Time(5s)));
  EXPECT_EQ(journey.HomeIsDue(map, far_W, Time(15s)), "time budget");
}

TEST(Journey, WithoutReturningHomeIsNeverDue) {
  const PlanningMap map = OneRoom();
  Journey journey({.time_budget = {}, .distance_budget = 1.0, .return_home = false, .way_home = {}});
  journey.FindWaysHome(map, kHome_W);
  EXPECT_FALSE(journey.way_home().home_W());
  EXPECT_FALSE(journey.TooFar(map, 100.0, kHome_W, Time(0s)));
}

TEST(Journey, ABadMarginIsNamed) {
  EXPECT_THROW(
      Journey({.time_budget = {}, .distance_budget = 0, .return_home = true, .way_home = {.margin = -0.1}}),
      std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::explorer
