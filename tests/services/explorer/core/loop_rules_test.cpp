#include "services/explorer/core/loop_rules.h"

#include <gtest/gtest.h>

#include "services/explorer/core/explorer.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

using std::chrono_literals::operator""s;
using test::kHere;
using test::kStart;

const RigidTransform kNearTheUnknown = test::At(5.55, 0.65, 0.65);

constexpr LoopRules kPrinted = LoopRules::Of(LoopRules::Set::kPrinted);

class LoopRulesTest : public testing::Test {
 protected:
  Explorer In(const std::vector<VoxelChange>& changes) const {
    Explorer explorer(options_);
    explorer.Update(changes, {}, kStart);
    return explorer;
  }
  Plan PlanIn(const std::vector<VoxelChange>& changes, const RigidTransform& T_WB = kHere) const {
    return In(changes).MakePlan(T_WB, kStart);
  }
  static std::vector<VoxelChange> RoomWithASpeck() {
    std::vector<VoxelChange> changes = test::ClosedRoom(test::kLongRoom);
    std::erase_if(changes, [](const VoxelChange& change) { return change.voxel == VoxelIndex{30, 6, 6}; });
    return changes;
  }
  /// With a wall from one side, around which the path to the far end leads.
  static std::vector<VoxelChange> RoomWithACorner() {
    std::vector<VoxelChange> changes = test::LongRoom();
    for (const VoxelChange& change : test::BoxOf({{25, 0, 0}, {27, 6, 12}}, VoxelState::kOccupied)) {
      changes.push_back(change);
    }
    return changes;
  }

  Explorer::Options options_ = test::GoingOptions();
};

TEST_F(LoopRulesTest, WithoutLookingAroundTheRobotGoesAtOnce) {
  EXPECT_EQ(PlanIn(test::LongRoom(), kNearTheUnknown).purpose, Purpose::kLookAround);
  options_.loop.look_around = false;
  EXPECT_EQ(PlanIn(test::LongRoom(), kNearTheUnknown).purpose, Purpose::kSeeFrontier);
}

TEST_F(LoopRulesTest, WithoutScansOnTheWayAPlanIsCarriedOutToItsEnd) {
  for (const bool on : {true, false}) {
    options_.loop.scan_on_the_way = on;
    Explorer explorer = In(test::LongRoom());
    ASSERT_EQ(explorer.MakePlan(kHere, kStart).purpose, Purpose::kSeeFrontier);
    explorer.Update(test::FarWall(), {}, kStart);
    EXPECT_EQ(explorer.CheckPlan(kHere), on ? std::optional(Interruption::kTargetSeen) : std::nullopt);
  }
}

TEST_F(LoopRulesTest, WithoutDroppingWhatIsSmallOneVoxelIsAFrontier) {
  EXPECT_EQ(test::EndOf(PlanIn(RoomWithASpeck())), Outcome::kComplete);
  options_.loop.drop_small = false;
  const Plan plan = PlanIn(RoomWithASpeck());
  EXPECT_EQ(plan.purpose, Purpose::kSeeFrontier);
  EXPECT_EQ(plan.target_unknown, 1U);
}

TEST_F(LoopRulesTest, WithoutSettingAsideAFruitlessVisitIsForgotten) {
  for (const bool on : {true, false}) {
    options_.loop.set_aside = on;
    Explorer explorer = In(test::LongRoom());
    const Plan plan = explorer.MakePlan(kHere, kStart);
    explorer.Arrived(kStart + 5s);
    EXPECT_EQ(explorer.status().set_aside.empty(), !on);
    const Plan next = explorer.MakePlan(plan.T_WBs.back(), kStart + 5s);
    EXPECT_EQ(next.purpose == Purpose::kSeeFrontier && next.frontiers == plan.frontiers, !on);
  }
}

TEST_F(LoopRulesTest, WhatAnOperatorIgnoresIsSetAsideAllTheSame) {
  options_.loop = kPrinted;
  Explorer explorer = In(test::LongRoom());
  const Plan plan = explorer.MakePlan(kHere, kStart);
  ASSERT_TRUE(plan.target_W);
  ASSERT_TRUE(explorer.Ignore(*plan.target_W, kStart));
  EXPECT_FALSE(explorer.status().set_aside.empty());
}

TEST_F(LoopRulesTest, WithoutStoppingShortThePathLeadsToTheFrontier) {
  const double shorter = PlanIn(test::LongRoom()).length;
  options_.loop.stop_short = false;
  EXPECT_GT(PlanIn(test::LongRoom()).length, shorter + 0.05);
}

TEST_F(LoopRulesTest, WithoutKeepingOffThePathPassesCloseByACorner) {
  const auto least_clearance = [&] {
    const Explorer explorer = In(RoomWithACorner());
    double least = 1.0;
    const Plan plan = PlanIn(RoomWithACorner());
    for (std::size_t n = 1; n < plan.T_WBs.size(); ++n) {
      least = std::min(
          least, explorer.map().SegmentClearance(plan.T_WBs[n - 1].translation(), plan.T_WBs[n].translation(),
                                                 PlanningMap::Obstacles::kOccupied, 1.0));
    }
    return least;
  };
  const double kept = least_clearance();
  options_.loop.keep_off = false;
  EXPECT_LT(least_clearance(), kept - 0.05);
}

TEST_F(LoopRulesTest, WithoutPullingStraightThePathLeadsFromVoxelToVoxel) {
  options_.loop = kPrinted;
  const auto longest_segment = [&] {
    const Plan plan = PlanIn(RoomWithACorner());
    double longest = 0.0;
    for (std::size_t n = 1; n < plan.T_WBs.size(); ++n) {
      longest = std::max(longest, (plan.T_WBs[n].translation() - plan.T_WBs[n - 1].translation()).norm());
    }
    return longest;
  };
  EXPECT_LT(longest_segment(), 0.18) << "a diagonal of a voxel";
  options_.loop.pull_straight = true;
  EXPECT_GT(longest_segment(), 0.5);
}

TEST_F(LoopRulesTest, WithoutFacingTheTargetTheRobotLooksWhereItGoes) {
  options_.loop.face_target = false;
  const Plan plan = PlanIn(RoomWithACorner());
  ASSERT_GT(plan.T_WBs.size(), 2U);
  for (std::size_t n = 1; n < plan.T_WBs.size(); ++n) {
    const Eigen::Vector3d segment_W = plan.T_WBs[n].translation() - plan.T_WBs[n - 1].translation();
    if (segment_W.norm() < 1e-9) continue;
    EXPECT_TRUE(plan.T_WBs[n].linear().col(0).isApprox(segment_W.normalized(), 1e-9)) << n;
  }
}

TEST_F(LoopRulesTest, WithAllRulesOffTheRobotFollowsTheLineOfThePotentialItself) {
  options_.loop = kPrinted;
  options_.strategy = Configure("potential_thesis");
  Explorer explorer = In(RoomWithACorner());
  const Plan plan = explorer.MakePlan(kHere, kStart);
  const std::vector<Eigen::Vector3d>& line_W = explorer.chosen_path_W();
  ASSERT_EQ(plan.T_WBs.size(), line_W.size());
  ASSERT_GT(line_W.size(), 20U);
  for (std::size_t n = 0; n < line_W.size(); ++n) EXPECT_EQ(plan.T_WBs[n].translation(), line_W[n]);
  EXPECT_EQ(explorer.map().IndexOf(line_W.back()).x, 59) << "the free voxels beside the unknown";
}

TEST_F(LoopRulesTest, ThePotentialOfTheThesisEndsWhereNoFrontierIsLeft) {
  options_.loop = kPrinted;
  options_.strategy = Configure("potential_thesis");
  EXPECT_EQ(test::EndOf(PlanIn(test::ClosedRoom(test::kLongRoom))), Outcome::kComplete);
}

}  // namespace
}  // namespace thalweg::explorer
