#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "services/explorer/core/explorer.h"
#include "tests/services/explorer/support/choosing_explorer.h"
#include "tests/services/explorer/support/rooms.h"

/// What an explorer remembers of its looks: what it sets aside, why, and how often it goes to what is
/// doubtful.
namespace thalweg::explorer {
namespace {

using ExplorerMemory = test::ChoosingExplorer;
using test::kHere;
using test::kStart;

INSTANTIATE_TEST_SUITE_P(Strategies, ExplorerMemory, testing::ValuesIn(test::ChoosingStrategies()),
                         [](const auto& its) { return std::string(its.param); });

TEST_P(ExplorerMemory, FrontiersThatStayUnknownAreSetAsideAndItEnds) {
  Explorer explorer = With(options_, test::LongRoom());
  RigidTransform T_WB = kHere;
  Plan plan = explorer.MakePlan(T_WB, kStart);
  int plans = 1;
  for (; plan.kind != Plan::Kind::kDone && plans < 50; ++plans) {
    T_WB = plan.T_WBs.back();
    explorer.Arrived(kStart);
    plan = explorer.MakePlan(T_WB, kStart);
  }
  EXPECT_EQ(test::EndOf(plan), Outcome::kComplete);
  EXPECT_LT(plans, 20);
  std::size_t aside = 0;
  std::size_t small = 0;
  for (const SetAsideCount& count : explorer.status().set_aside) {
    EXPECT_NE(count.reason, AsideReason::kNone);
    aside += count.voxels;
    if (count.reason == AsideReason::kTooSmall) small += count.voxels;
  }
  EXPECT_EQ(aside, 144U);
  std::size_t reported = 0;
  for (const FrontierReport& report : explorer.frontier_reports()) {
    EXPECT_EQ(report.fate, FrontierReport::Fate::kSetAside);
    EXPECT_NE(report.reason, AsideReason::kNone);
    EXPECT_NEAR(report.center_W.x(), 6.05, 1e-9);
    reported += report.voxels;
  }
  EXPECT_EQ(reported, 144U - small);
  EXPECT_TRUE(explorer.chosen_path_W().empty());
}

TEST_P(ExplorerMemory, WithMoreLeftUnknownThanIsAllowedTheEndIsNotComplete) {
  // The far wall, 144 voxels, stays unknown; the other walls have 4 * 60 * 12 + 144.
  constexpr double kShare = 144.0 / (144.0 + 4 * 60 * 12 + 144.0);
  for (const double allowed : {1.01 * kShare, 0.99 * kShare}) {
    options_.max_missed_share = allowed;
    options_.frontier.min_area = 0.01;  // nothing is too small
    Explorer explorer = With(options_, test::LongRoom());
    Plan plan = explorer.MakePlan(kHere, kStart);
    for (int plans = 0; plan.kind != Plan::Kind::kDone && plans < 100; ++plans) {
      explorer.Arrived(kStart);
      plan = explorer.MakePlan(plan.T_WBs.back(), kStart);
    }
    ASSERT_TRUE(plan.ending);
    EXPECT_EQ(plan.ending->outcome, allowed > kShare ? Outcome::kComplete : Outcome::kTooMuchUnknown);
    EXPECT_NEAR(plan.ending->missed_area, 1.44, 1e-9);
    EXPECT_NEAR(plan.ending->missed_share, kShare, 1e-12);
    double missed = 0.0;
    for (const Ending::Missed& part : plan.ending->missed) missed += part.area;
    EXPECT_NEAR(missed, 1.44, 1e-9);
  }
}

/// Occupied voxels of the far wall with these log odds: 4 x 4 of them.
std::vector<VoxelChange> DoubtfulPatch(float log_odds) {
  std::vector<VoxelChange> changes = test::BoxOf({{60, 4, 4}, {61, 8, 8}}, VoxelState::kOccupied);
  for (VoxelChange& change : changes) change.log_odds = log_odds;
  return changes;
}

TEST_P(ExplorerMemory, WhatIsDoubtfulIsGoneToUntilItIsSure) {
  for (const double max_log_odds : {0.0, 0.5}) {
    options_.doubt.max_log_odds = max_log_odds;
    Explorer explorer = With(options_, test::ClosedRoom(test::kLongRoom));
    explorer.Update(DoubtfulPatch(0.2F), {}, kStart);
    const Plan plan = explorer.MakePlan(kHere, kStart);
    if (max_log_odds == 0.0) {
      EXPECT_EQ(test::EndOf(plan), Outcome::kComplete);
      continue;
    }
    ASSERT_EQ(plan.kind, Plan::Kind::kGo);
    EXPECT_GT(plan.T_WBs.back().translation().x(), 4.5);
    EXPECT_GT(plan.T_WBs.back().linear()(0, 0), 0.5);
    EXPECT_GT(plan.target_doubtful, 0U);
    EXPECT_EQ(plan.target_unknown, 0U);
    EXPECT_EQ(plan.frontiers, 1U);
    ASSERT_EQ(explorer.frontier_reports().size(), 1U);
    EXPECT_EQ(explorer.frontier_reports()[0].reason, AsideReason::kNone);
    EXPECT_TRUE(explorer.frontier_reports()[0].doubtful);
    EXPECT_FALSE(explorer.CheckPlan(kHere));
    explorer.Update(DoubtfulPatch(-0.2F), {}, kStart);
    EXPECT_FALSE(explorer.CheckPlan(kHere)) << "that it may rather be free makes it no surer";
    explorer.Update(DoubtfulPatch(1.0F), {}, kStart);
    EXPECT_TRUE(explorer.CheckPlan(kHere));
    EXPECT_EQ(test::EndOf(explorer.MakePlan(kHere, kStart)), Outcome::kComplete);
  }
}

TEST_P(ExplorerMemory, WhatStaysDoubtfulIsSetAsideAndTheEndIsComplete) {
  options_.doubt.max_log_odds = 0.5;
  options_.max_missed_share = 0.0;
  Explorer explorer = With(options_, test::ClosedRoom(test::kLongRoom));
  explorer.Update(DoubtfulPatch(0.2F), {}, kStart);
  Plan plan = explorer.MakePlan(kHere, kStart);
  int plans = 1;
  for (; plan.kind != Plan::Kind::kDone && plans < 50; ++plans) {
    explorer.Arrived(kStart);
    plan = explorer.MakePlan(plan.T_WBs.back(), kStart);
  }
  EXPECT_LT(plans, 5);
  ASSERT_EQ(test::EndOf(plan), Outcome::kComplete);
  EXPECT_EQ(plan.ending->doubtful_voxels, 16U);
  EXPECT_TRUE(plan.ending->missed.empty());
  std::size_t voxels = 0;
  for (const SetAsideCount& count : explorer.status().set_aside) {
    EXPECT_TRUE(count.doubtful);
    EXPECT_TRUE(count.reason == AsideReason::kVisited || count.reason == AsideReason::kTooSmall)
        << NameOf(count.reason);
    voxels += count.voxels;
  }
  EXPECT_EQ(voxels, 16U);
  ASSERT_EQ(explorer.frontier_reports().size(), 1U);
  EXPECT_EQ(explorer.frontier_reports()[0].reason, AsideReason::kVisited);
  EXPECT_TRUE(explorer.frontier_reports()[0].doubtful);
}

TEST_P(ExplorerMemory, ScansThatContradictEachOtherDoNotKeepItForEver) {
  options_.doubt.max_log_odds = 0.5;
  Explorer explorer = With(options_, test::ClosedRoom(test::kLongRoom));
  Plan plan;
  RigidTransform T_WB = kHere;
  int gone = 0;
  for (int round = 0; round < 50; ++round) {
    explorer.Update(DoubtfulPatch(0.2F), {}, kStart);
    plan = explorer.MakePlan(T_WB, kStart);
    if (plan.kind == Plan::Kind::kDone) break;
    ++gone;
    T_WB = plan.T_WBs.back();
    explorer.Update(DoubtfulPatch(1.0F), {}, kStart);
    explorer.Arrived(kStart);
    EXPECT_EQ(explorer.memory().SetAsideVoxels().size(), 0U) << "it was right to go there";
  }
  EXPECT_EQ(test::EndOf(plan), Outcome::kComplete);
  EXPECT_EQ(gone, LookMemory::Options{}.chances);
}

/// Number of voxels set aside, by reason.
std::map<AsideReason, std::size_t> SetAside(const Explorer& explorer) {
  std::map<AsideReason, std::size_t> voxels;
  for (const SetAsideCount& count : explorer.status().set_aside) {
    EXPECT_FALSE(count.doubtful);
    voxels[count.reason] += count.voxels;
  }
  return voxels;
}

/// A look from `T_WB` along the body's x axis that measured the given shares of the columns of image cells.
ScanView LookFrom(const RigidTransform& T_WB, const std::array<double, MeasuredShares::kSide>& columns) {
  MeasuredShares shares;
  for (std::size_t k = 0; k < shares.of_255.size(); ++k)
    shares.of_255[k] = static_cast<std::uint8_t>(std::lround(255.0 * columns[k % columns.size()]));
  return {.T_WC = T_WB * RobotModel{}.T_BC, .measured = shares};
}
constexpr std::array<double, 8> kNothing{};
constexpr std::array<double, 8> kAll{1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};

TEST(ExplorerMemoryOfLooks, LooksInDirectionsWhereNothingWasMeasuredAreKeptApart) {
  // Two looks at the unseen far end, taken 0.3 m apart. The left half of the image shows y > 0.6 m.
  const std::array<double, 8> left_only{1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0};
  const std::array<double, 8> little{0.2, 0.2, 0.2, 0.2, 0.3, 0.3, 0.3, 0.3};
  const struct {
    std::array<double, 8> first, second;
    double min_share;
    std::size_t no_depth, looked_at;
  } cases[] = {
      {kAll, kAll, 0.25, 0, 144},        {kNothing, kNothing, 0.25, 144, 0},
      {kNothing, kAll, 0.25, 0, 144},    {left_only, left_only, 0.25, 72, 72},
      {little, little, 0.25, 72, 72},    {little, little, 0.31, 144, 0},
      {kNothing, kNothing, 0.0, 0, 144},
  };
  for (const auto& [first, second, min_share, no_depth, looked_at] : cases) {
    Explorer::Options options = test::GoingOptions();
    options.min_measured_share = min_share;
    options.look_range = 2.0;
    Explorer explorer(options);
    explorer.Update(test::LongRoom(), {}, kStart);
    const ScanView scans[] = {LookFrom(test::At(5.1, 0.6, 0.6), first),
                              LookFrom(test::At(4.8, 0.6, 0.6), second)};
    explorer.Update({}, scans, kStart);
    std::map<AsideReason, std::size_t> aside = SetAside(explorer);
    EXPECT_EQ(aside[AsideReason::kNoDepth], no_depth);
    EXPECT_EQ(aside[AsideReason::kLookedAt], looked_at);
  }
}

TEST(ExplorerMemoryOfLooks, AScanThatDoesNotSayWhatItMeasuredCountsAsOneThatDid) {
  Explorer::Options options = test::GoingOptions();
  options.look_range = 2.0;
  Explorer explorer(options);
  explorer.Update(test::LongRoom(), {}, kStart);
  const RigidTransform T_BC = RobotModel{}.T_BC;
  const ScanView scans[] = {{.T_WC = test::At(5.1, 0.6, 0.6) * T_BC},
                            {.T_WC = test::At(4.8, 0.6, 0.6) * T_BC}};
  explorer.Update({}, scans, kStart);
  EXPECT_EQ(SetAside(explorer), (std::map<AsideReason, std::size_t>{{AsideReason::kLookedAt, 144U}}));
}

TEST_P(ExplorerMemory, AFruitlessVisitToWhereNothingIsMeasuredSaysSo) {
  for (const auto& [shares, reason] :
       {std::pair{kNothing, AsideReason::kNoDepth}, {kAll, AsideReason::kVisited}}) {
    Explorer explorer = With(options_, test::LongRoom());
    const Plan plan = explorer.MakePlan(kHere, kStart);
    ASSERT_EQ(plan.kind, Plan::Kind::kGo);
    const ScanView scan = LookFrom(plan.T_WBs.back(), shares);
    explorer.Update({}, {&scan, 1}, kStart);
    EXPECT_TRUE(explorer.memory().SetAsideVoxels().empty()) << "one look";
    explorer.Arrived(kStart);
    const std::map<AsideReason, std::size_t> aside = SetAside(explorer);
    ASSERT_EQ(aside.size(), 1U);
    EXPECT_EQ(aside.begin()->first, reason);
  }
}

TEST_P(ExplorerMemory, ALookAroundWhereNothingIsMeasuredSaysSo) {
  options_.look_around_min_area = 0.2;
  for (const auto& [shares, reason] :
       {std::pair{kNothing, AsideReason::kNoDepth}, {kAll, AsideReason::kLookedAt}}) {
    Explorer explorer = With(options_, test::LongRoom());
    const Plan plan = explorer.MakePlan(test::At(5.55, 0.65, 0.65), kStart);
    ASSERT_EQ(plan.kind, Plan::Kind::kLook);
    const ScanView scan = LookFrom(plan.T_WBs.back(), shares);
    explorer.Update({}, {&scan, 1}, kStart);
    explorer.Arrived(kStart);
    const std::map<AsideReason, std::size_t> aside = SetAside(explorer);
    ASSERT_EQ(aside.size(), 1U);
    EXPECT_EQ(aside.begin()->first, reason);
  }
}

}  // namespace
}  // namespace thalweg::explorer
