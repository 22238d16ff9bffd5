#include "services/evaluator/core/tail.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace thalweg::evaluator {
namespace {

using explorer::Plan;
using explorer::PlanningMap;
using explorer::Purpose;

/// A corridor along x, 3 voxels wide and high, with unknown pockets in its side wall. The robot is in its
/// middle, at y = 0.15, z = 0.15.
class TailTest : public testing::Test {
 protected:
  TailTest() {
    std::vector<VoxelChange> changes;
    for (int x = 0; x < 120; ++x) {
      for (int y = -1; y < 4; ++y) {
        for (int z = -1; z < 4; ++z) {
          const bool inside = y >= 0 && y < 3 && z >= 0 && z < 3;
          changes.push_back({{x, y, z}, inside ? -2.0F : 2.0F});
        }
      }
    }
    map_.Apply(changes);
    map_.Apply(std::vector<VoxelChange>{{{-1, 0, 0}, 2.0F}});
  }

  /// Makes the wall's voxels beside x unknown, as if a pocket began there.
  std::vector<VoxelIndex> OpenPocket(int x, int width = 2) {
    std::vector<VoxelIndex> pocket;
    for (int k = 0; k < width; ++k) pocket.push_back({x + k, 3, 1});
    Set(pocket, std::numeric_limits<float>::quiet_NaN(), VoxelState::kUnknown);
    return pocket;
  }
  void See(const std::vector<VoxelIndex>& voxels) { Set(voxels, 2.0F, VoxelState::kOccupied); }

  void Set(const std::vector<VoxelIndex>& voxels, float log_odds, VoxelState state) {
    std::vector<VoxelChange> changes;
    for (const VoxelIndex& i : voxels) changes.push_back({i, log_odds});
    map_.Apply(changes);
    for (const VoxelIndex& i : voxels) ASSERT_EQ(map_.State(i), state);
  }

  /// Flies along the corridor with a scan each 0.1 m, to the given x [m].
  void FlyTo(double x) {
    while (std::abs(x - x_) > 1e-9) {
      const double step = std::clamp(x - x_, -0.1, 0.1);
      x_ += step;
      distance_ += std::abs(step);
      Scan();
    }
  }
  void Scan() { recorder_.OnScan(distance_, coverage_, {x_, 0.15, 0.15}, map_); }
  void GoFor(const std::vector<VoxelIndex>& target) {
    Plan plan;
    plan.kind = Plan::Kind::kGo;
    plan.purpose = Purpose::kSeeFrontier;
    recorder_.OnPlan(plan, target);
  }
  void Turn() {
    Plan plan;
    plan.kind = Plan::Kind::kLook;
    plan.purpose = Purpose::kLookAround;
    recorder_.OnPlan(plan, {});
  }
  void GoHome() {
    Plan plan;
    plan.kind = Plan::Kind::kGo;
    plan.purpose = Purpose::kGoHome;
    recorder_.OnPlan(plan, {});
  }

  PlanningMap map_{{.voxel_size = 0.1, .clearance = 0.1, .bounds = {}}};
  TailRecorder recorder_;
  double x_ = 0.15;
  double distance_ = 0.0;
  double coverage_ = 0.0;
};

TEST_F(TailTest, ReportsWhatWasPassedByFromWhatIsNewAtHandOrInVain) {
  const auto passed = OpenPocket(30);   // x = 3 m
  const auto at_hand = OpenPocket(75);  // 7.5 m
  FlyTo(8.15);                          // past both; the first is 5 m behind, the second has just been passed
  coverage_ = 0.96;
  Scan();
  EXPECT_NEAR(distance_, 8.0, 1e-9);

  GoFor(at_hand);
  FlyTo(7.55);
  See(at_hand);
  Scan();
  const auto fresh = OpenPocket(110, 3);  // 11 m: appears only now, and not in sight within 2 m
  GoFor(fresh);
  FlyTo(10.55);
  See({fresh[0]});
  Scan();
  GoFor(passed);
  FlyTo(3.15);
  See(passed);
  Scan();
  const auto vain = OpenPocket(20);
  GoFor(vain);
  FlyTo(2.15);
  Scan();
  GoHome();
  FlyTo(0.15);

  const Tail tail = recorder_.Finish(distance_);
  ASSERT_TRUE(tail.begins);
  EXPECT_NEAR(*tail.begins, 8.0, 1e-9);
  ASSERT_EQ(tail.journeys.size(), 4U);
  const Tail::Journey expected[] = {{0.6, 2, Tail::Kind::kAtHand, true},
                                    {3.0, 3, Tail::Kind::kNew, false},
                                    {7.4, 2, Tail::Kind::kPassedBy, true},
                                    {1.0, 2, Tail::Kind::kInVain, false}};
  for (std::size_t n = 0; n < 4; ++n) {
    EXPECT_NEAR(tail.journeys[n].length, expected[n].length, 1e-9) << n;
    EXPECT_EQ(tail.journeys[n].voxels, expected[n].voxels) << n;
    EXPECT_EQ(tail.journeys[n].kind, expected[n].kind) << n;
    EXPECT_EQ(tail.journeys[n].was_in_sight, expected[n].was_in_sight) << n;
  }
  EXPECT_NEAR(tail.other, 2.0, 1e-9);
  EXPECT_NEAR(tail.length(), distance_ - 8.0, 1e-9);
}

TEST_F(TailTest, APocketThatWasLeftStaysPassedByWhenTheRobotHappensToComeBack) {
  const auto pocket = OpenPocket(30);
  FlyTo(8.15);
  FlyTo(3.15);
  coverage_ = 0.97;
  GoFor(pocket);
  FlyTo(3.05);
  See(pocket);
  FlyTo(2.95);
  const Tail tail = recorder_.Finish(distance_);
  ASSERT_EQ(tail.journeys.size(), 1U);
  EXPECT_EQ(tail.journeys[0].kind, Tail::Kind::kPassedBy);
}

TEST_F(TailTest, APocketWhoseBorderHasMovedIsTheSame) {
  OpenPocket(30);
  FlyTo(8.15);
  const auto moved = OpenPocket(33);  // two voxels on from the pocket's second
  const auto elsewhere = OpenPocket(20);
  coverage_ = 0.96;
  Scan();
  GoFor(moved);
  FlyTo(5.65);
  See(moved);
  Scan();
  GoFor(elsewhere);
  FlyTo(5.05);
  See(elsewhere);
  Scan();
  const Tail tail = recorder_.Finish(distance_);
  ASSERT_EQ(tail.journeys.size(), 2U);
  EXPECT_EQ(tail.journeys[0].kind, Tail::Kind::kPassedBy);
  EXPECT_EQ(tail.journeys[1].kind, Tail::Kind::kNew);
}

TEST_F(TailTest, WhatIsBehindAWallIsNearbyButNotInSight) {
  const auto pocket = OpenPocket(30);
  const std::vector<VoxelIndex> curtain = [] {
    std::vector<VoxelIndex> voxels;
    for (int y = 0; y < 3; ++y) {
      for (int z = 0; z < 3; ++z) voxels.push_back({25, y, z});
    }
    return voxels;
  }();
  See(curtain);
  FlyTo(2.45);  // 0.6 m before the pocket, the curtain between them
  FlyTo(0.15);
  FlyTo(2.45);
  coverage_ = 0.95;
  Scan();
  GoFor(pocket);
  x_ = 2.95;
  distance_ += 0.5;
  See(pocket);
  Scan();
  const Tail tail = recorder_.Finish(distance_);
  ASSERT_EQ(tail.journeys.size(), 1U);
  EXPECT_EQ(tail.journeys[0].kind, Tail::Kind::kAtHand) << "it was out of reach for 1.8 m of path only";
  EXPECT_FALSE(tail.journeys[0].was_in_sight);
}

TEST_F(TailTest, AnInterruptedJourneyThatGoesOnIsOneAndTurnsAreNone) {
  const auto pocket = OpenPocket(60);
  coverage_ = 0.96;
  Scan();
  GoFor(pocket);
  FlyTo(2.15);
  Turn();
  GoFor(pocket);
  FlyTo(6.15);
  See(pocket);
  Scan();
  const Tail tail = recorder_.Finish(distance_);
  ASSERT_EQ(tail.journeys.size(), 1U);
  EXPECT_NEAR(tail.journeys[0].length, 6.0, 1e-9);
  EXPECT_EQ(tail.journeys[0].kind, Tail::Kind::kNew);
}

TEST_F(TailTest, OfTheJourneyDuringWhichItBeginsOnlyTheRestCounts) {
  const auto pocket = OpenPocket(60);
  Scan();
  GoFor(pocket);
  FlyTo(4.15);
  coverage_ = 0.95;
  Scan();
  FlyTo(6.15);
  See(pocket);
  Scan();
  const Tail tail = recorder_.Finish(distance_);
  EXPECT_NEAR(tail.begins.value(), 4.0, 1e-9);
  ASSERT_EQ(tail.journeys.size(), 1U);
  EXPECT_NEAR(tail.journeys[0].length, 2.0, 1e-9);
}

TEST_F(TailTest, ARunThatDoesNotGetThereHasNone) {
  coverage_ = 0.949;
  GoFor(OpenPocket(60));
  FlyTo(6.15);
  const Tail tail = recorder_.Finish(distance_);
  EXPECT_FALSE(tail.begins);
  EXPECT_TRUE(tail.journeys.empty());
  EXPECT_EQ(tail.length(), 0.0);
}

TEST(TailKind, IsParsedFromItsText) {
  for (const Tail::Kind kind : Tail::kKinds) EXPECT_EQ(TailKindNamed(NameOf(kind)), kind);
  EXPECT_FALSE(TailKindNamed("elsewhere"));
}

}  // namespace
}  // namespace thalweg::evaluator
