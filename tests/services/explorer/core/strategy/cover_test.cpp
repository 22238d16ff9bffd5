#include "services/explorer/core/strategy/cover.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "services/explorer/core/view/goal_finder.h"
#include "tests/services/explorer/support/situations.h"

namespace thalweg::explorer {
namespace {

using test::kLookRange;
using test::kSize;
using test::kViews;

class CoverOnRandomMaps : public test::OnRandomMaps {};
INSTANTIATE_TEST_SUITE_P(Seeds, CoverOnRandomMaps, testing::Range(1U, 21U));

TEST_P(CoverOnRandomMaps, KeepsToFreeSpaceAndIsTheSameEachTime) {
  const DenseGrid<std::uint8_t> none(map_.box(), 0);
  const std::vector<Candidate> unseen = candidates_;  // without unknown voxels
  candidates_.clear();
  for (const Cluster& cluster : FindFrontiers(map_, none, {}).clusters) {
    const GoalFinder finder(kLookRange, kSize);
    std::vector<VoxelIndex> goals = finder.GoalsOf(cluster, map_, search_, kViews);
    if (goals.empty()) continue;
    const double length = search_.Length(goals.front());
    candidates_.push_back({.cluster = cluster, .goals = std::move(goals), .length = length});
  }
  std::vector<Candidate> seen = candidates_;
  for (int n = 0; n < 4; ++n) {
    const bool is_timed = n % 2 == 1;
    candidates_ = n < 2 && !seen.empty() ? seen : unseen;
    Situation its = situation();
    if (is_timed) its.time = TimedRobot{RobotModel{}, RotationFromYawPitch(0.1 * GetParam(), 0.0)};
    Cover cover({.least_yield = 0.0});
    Cover again({.least_yield = 0.0});
    for (int m = 0; m < 4; ++m) {
      const Choice choice = cover.Choose(its);
      ASSERT_LT(choice.candidate, candidates_.size());
      ExpectGoodPath(choice);
      const Choice same = again.Choose(its);
      EXPECT_EQ(same.candidate, choice.candidate);
      EXPECT_EQ(same.path_W, choice.path_W);
      EXPECT_EQ(same.target, choice.target);
    }
  }
}

class CoverAmongSpecks : public test::RoomWithSpecks {};

TEST_F(CoverAmongSpecks, MakesNoDetourWhereOnePositionSeesAll) {
  const std::vector<VoxelIndex> specks = {{60, 4, 6}, {62, 26, 6}};
  PutSpecks(specks);
  double shortest = std::numeric_limits<double>::infinity();
  for (const VoxelIndex& i : traversable_) {
    if (Sees(i, specks[0]) && Sees(i, specks[1])) shortest = std::min(shortest, search_.Length(i));
  }
  const Choice choice = Cover({.least_yield = 0.0}).Choose(situation());
  const VoxelIndex end = map_.IndexOf(choice.path_W.back());
  ASSERT_FALSE(choice.target.empty());
  PathSearch onward;
  onward.Flood(map_, {{end, 0}});
  double longest_rest = 0.0;  // to what is not seen from there
  for (const VoxelIndex& speck : specks) {
    double rest = std::numeric_limits<double>::infinity();
    for (const VoxelIndex& i : traversable_) {
      if (Sees(i, speck)) rest = std::min(rest, onward.Length(i));
    }
    longest_rest = std::max(longest_rest, rest);
    EXPECT_EQ(testing::Value(choice.target, testing::Contains(speck)), Sees(end, speck));
  }
  // One voxel of each cell of 0.4 m was tried.
  EXPECT_LE(search_.Length(end) + longest_rest, shortest + 0.8);
}

TEST_F(CoverAmongSpecks, LeavesOutWhatIsNotWorthItsPath) {
  PutSpecks({{60, 4, 6}});  // 0.01 m^2, some 3 m away
  EXPECT_TRUE(Cover({.least_yield = 0.1}).Choose(situation()).path_W.empty());
  EXPECT_FALSE(Cover({.least_yield = 0.001}).Choose(situation()).path_W.empty());
}

TEST_F(CoverAmongSpecks, TurnsToWhatItSeesFromHereButOnlyOnce) {
  std::vector<VoxelIndex> near;
  for (int y = 9; y < 21; ++y) near.push_back({20, y, 6});
  PutSpecks(near);
  Cover cover({.least_yield = 0.0});
  const Choice look = cover.Choose(situation());
  EXPECT_THAT(look.path_W, testing::Each(map_.CenterOf(kStart)));
  EXPECT_THAT(look.target, testing::IsSubsetOf(near));
  EXPECT_GE(look.target.size(), 10U);
  // Whatever the look has not resolved is looked at from elsewhere.
  const Choice go = cover.Choose(situation());
  EXPECT_GT(PathLength(go.path_W), 0.2);
}

/// A robot that looks away from what is ahead of it.
TimedRobot LookingBack(double max_turn_rate) {
  RobotModel robot;
  robot.max_turn_rate = max_turn_rate;
  return {robot, RotationFromYawPitch(std::numbers::pi, 0.0)};
}

TEST_F(CoverAmongSpecks, WhereTimeCountsItTurnsOnlyToWhatIsWorthTheTurn) {
  std::vector<VoxelIndex> near;
  for (int y = 9; y < 21; ++y) near.push_back({20, y, 6});
  PutSpecks(near);  // 0.12 m^2, worth 1.2 m
  Situation timed = situation();
  timed.time = LookingBack(3.0);  // 1 s, 0.25 m
  Cover cover({.least_yield = 0.1});
  const Choice look = cover.Choose(timed);
  EXPECT_THAT(look.path_W, testing::Each(map_.CenterOf(kStart)));
  EXPECT_THAT(look.target, testing::IsSupersetOf({near[5], near[6]}));
  // What the look has not resolved is looked at from elsewhere, if that is worth it.
  const Choice next = cover.Choose(timed);
  EXPECT_TRUE(next.path_W.empty() || PathLength(next.path_W) > 0.2);
  timed.time = LookingBack(0.2);  // 16 s, 4 m
  EXPECT_TRUE(Cover({.least_yield = 0.1}).Choose(timed).path_W.empty());
}

TEST_F(CoverAmongSpecks, WhereTimeCountsItLooksOnTheWayRatherThanBackAndForth) {
  // One behind the robot, which looks along x, and one far ahead to its right, where it comes by with the
  // camera turned that way.
  PutSpecks({{1, 15, 6}, {60, 4, 6}});
  Situation timed = situation();
  timed.time = TimedRobot{RobotModel{}, Eigen::Matrix3d::Identity()};
  timed.time->model.max_turn_rate = 0.1;
  const Choice choice = Cover({.least_yield = 0.0}).Choose(timed);
  EXPECT_THAT(choice.target, testing::ElementsAre(VoxelIndex{60, 4, 6})) << "a turn back takes half a minute";
  ASSERT_TRUE(choice.R_WB) << "the view belongs to the choice";
  const Eigen::Vector3d offset_W = map_.CenterOf({60, 4, 6}) - map_.EyeAt(choice.path_W.back());
  EXPECT_TRUE(timed.views.Shows(*choice.R_WB, {{60, 4, 6}, offset_W}));
  EXPECT_FALSE(Cover({.least_yield = 0.0}).Choose(situation()).R_WB) << "where only the path counts";
  timed.time = LookingBack(0.2);
  EXPECT_THAT(Cover({.least_yield = 0.0}).Choose(timed).target, testing::ElementsAre(VoxelIndex{1, 15, 6}));
}

TEST(Cover, RefusesOptionsThatMakeNoSense) {
  EXPECT_THROW(Cover({.eagerness = -1.0}), std::invalid_argument);
  EXPECT_THROW(Cover({.least_yield = std::nan("")}), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::explorer
