#include "services/explorer/core/frontier_report.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/services/explorer/support/knowing.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

using test::kNow;
using Fate = FrontierReport::Fate;

Candidate CandidateOf(std::size_t voxels, double x, double length) {
  Candidate candidate;
  candidate.cluster = {.unknowns = std::vector<VoxelIndex>(voxels), .center_W = {x, 0, 0}};
  candidate.length = length;
  return candidate;
}

/// A room whose far end, of 12 x 12 voxels, is unknown.
class FrontierReportTest : public testing::Test {
 protected:
  /// Sets the voxels of the far end from y to end_y aside.
  void SetAside(int y, int end_y, AsideReason reason) {
    test::ForEachVoxel({{60, y, 0}, {61, end_y, 12}},
                       [&](const VoxelIndex& i) { knowledge_.memory().SetAside(i, reason, kNow); });
  }

  Knowledge knowledge_ = test::Knowing(test::LongRoom());
  CandidateSearch search_{test::SearchingOptions()};
};

TEST_F(FrontierReportTest, MarksTheChosenOfTheCandidates) {
  const std::vector<Candidate> candidates = {CandidateOf(7, 1.0, 2.0), CandidateOf(9, 3.0, 4.0)};
  Choice choice{.candidate = 1, .path_W = {{0, 0, 0}}, .target = {}, .scores = {0.5, 0.75}};
  std::vector<FrontierReport> reports = ReportFrontiers(knowledge_, candidates, choice);
  ASSERT_EQ(reports.size(), 2U);
  EXPECT_EQ(reports[0].fate, Fate::kLeft);
  EXPECT_EQ(reports[1].fate, Fate::kChosen);
  EXPECT_EQ(reports[1].center_W.x(), 3.0);
  EXPECT_EQ(reports[1].voxels, 9U);
  EXPECT_EQ(reports[1].length, 4.0);
  EXPECT_EQ(reports[1].score, 0.75);
  choice.path_W.clear();
  choice.scores.clear();
  reports = ReportFrontiers(knowledge_, candidates, choice);
  EXPECT_EQ(reports[1].fate, Fate::kLeft) << "a choice without a path goes nowhere";
  EXPECT_TRUE(std::isnan(reports[1].score));
}

TEST_F(FrontierReportTest, WhatIsSetAsideIsReportedByReasonAndComponent) {
  SetAside(0, 3, AsideReason::kVisited);
  SetAside(3, 5, AsideReason::kOutOfSight);
  SetAside(8, 12, AsideReason::kVisited);
  const std::vector<FrontierReport> reports = ReportFrontiers(knowledge_, {}, {});
  ASSERT_EQ(reports.size(), 3U);
  std::size_t visited = 0;
  for (const FrontierReport& report : reports) {
    EXPECT_EQ(report.fate, Fate::kSetAside);
    EXPECT_TRUE(std::isnan(report.length));
    EXPECT_NEAR(report.center_W.x(), 6.05, 1e-9);
    EXPECT_NEAR(report.center_W.z(), 0.6, 1e-9);
    if (report.reason == AsideReason::kVisited) ++visited;
    const double width = static_cast<double>(report.voxels) / 12.0;  // [voxels]
    const double middle = report.reason == AsideReason::kOutOfSight ? 0.4 : width == 3.0 ? 0.15 : 1.0;
    EXPECT_NEAR(report.center_W.y(), middle, 1e-9);
  }
  EXPECT_EQ(visited, 2U);
}

TEST_F(FrontierReportTest, CountsWhatIsSetAsideAndWhatIsTooSmall) {
  SetAside(0, 3, AsideReason::kVisited);
  SetAside(8, 12, AsideReason::kVisited);
  Frontiers frontiers;
  frontiers.small_clusters = 2;
  frontiers.small_voxels = 5;
  frontiers.small_doubtful_clusters = 1;
  frontiers.small_doubtful_voxels = 4;
  const std::vector<SetAsideCount> counts = CountSetAside(knowledge_, frontiers);
  ASSERT_EQ(counts.size(), 3U);
  EXPECT_EQ(counts[0].reason, AsideReason::kVisited);
  EXPECT_EQ(counts[0].clusters, 2U);
  EXPECT_EQ(counts[0].voxels, 7U * 12U);
  EXPECT_EQ(counts[1].reason, AsideReason::kTooSmall);
  EXPECT_FALSE(counts[1].doubtful);
  EXPECT_EQ(counts[1].clusters, 2U);
  EXPECT_EQ(counts[1].voxels, 5U);
  EXPECT_TRUE(counts[2].doubtful);
  EXPECT_EQ(counts[2].clusters, 1U);
  EXPECT_EQ(counts[2].voxels, 4U);
}

TEST_F(FrontierReportTest, DoubtfulVoxelsAreReportedApart) {
  Knowledge::Options options = test::KnowingOptions();
  options.map.doubt.max_log_odds = 0.5;
  std::vector<VoxelChange> changes = test::LongRoom();
  changes.push_back({{60, 0, 0}, 0.4F});
  knowledge_ = test::Knowing(changes, options);
  SetAside(0, 3, AsideReason::kVisited);
  const std::vector<SetAsideCount> counts = CountSetAside(knowledge_, {});
  ASSERT_EQ(counts.size(), 2U);
  EXPECT_FALSE(counts[0].doubtful);
  EXPECT_EQ(counts[0].voxels, 35U);
  EXPECT_TRUE(counts[1].doubtful);
  EXPECT_EQ(counts[1].voxels, 1U);
}

TEST_F(FrontierReportTest, TheEndingSaysHowMuchOfTheBorderStayedUnknown) {
  // Faces of the room: four sides of 60 x 12 voxels and the near end of 12 x 12; edges border on nothing.
  constexpr double kSurface = 4.0 * 60.0 * 12.0 + 144.0;
  SetAside(0, 6, AsideReason::kLookedAt);
  SetAside(6, 12, AsideReason::kOutOfSight);
  const Ending ending = EndingWithNothingLeft(knowledge_, 1.0, search_);
  EXPECT_EQ(ending.outcome, Outcome::kComplete);
  EXPECT_NEAR(ending.missed_area, 1.44, 1e-9);
  EXPECT_NEAR(ending.missed_share, 144.0 / (kSurface + 144.0), 1e-12);
  ASSERT_EQ(ending.missed.size(), 2U);
  for (const Ending::Missed& missed : ending.missed) EXPECT_NEAR(missed.area, 0.72, 1e-9);
  // Half of it was looked at in vain; what no place sees is no reason to doubt the exploration.
  const double in_vain = 72.0 / (kSurface + 144.0);
  EXPECT_EQ(EndingWithNothingLeft(knowledge_, in_vain + 1e-6, search_).outcome, Outcome::kComplete);
  EXPECT_EQ(EndingWithNothingLeft(knowledge_, in_vain - 1e-6, search_).outcome, Outcome::kTooMuchUnknown);
}

TEST_F(FrontierReportTest, WhatIsHiddenIsMissedAsWellWhereTheEndingDependsOnIt) {
  knowledge_ = test::Knowing(test::RoomWithABar(20));
  test::ForEachVoxel({{20, 0, 0}, {21, 12, 12}}, [&](const VoxelIndex& i) {
    knowledge_.memory().SetAside(i, AsideReason::kNoDepth, kNow);
  });
  const Mission mission({.time_budget = {}, .distance_budget = 0.0, .return_home = false, .home_paths = {}});
  StageTimings timings;
  search_.Find({0.55, 0.65, 0.65}, mission, kNow, knowledge_, timings);
  const double border = 4.0 * 56.0 * 12.0 + 4.0 * 144.0;
  const auto end = [&](double share) { return EndingWithNothingLeft(knowledge_, share, search_); };
  EXPECT_EQ(end(432.0 / border + 1e-6).outcome, Outcome::kComplete);
  EXPECT_EQ(end(432.0 / border + 1e-6).hidden_area, 0.0) << "so little is open that it does not matter";
  EXPECT_EQ(end(432.0 / border - 1e-6).outcome, Outcome::kTooMuchUnknown);
  EXPECT_NEAR(end(432.0 / border - 1e-6).hidden_area, 2.88, 1e-9) << "the far side of it, and the far end";
  EXPECT_EQ(end(144.0 / border - 1e-6).outcome, Outcome::kTooMuchUnknown);
  EXPECT_EQ(end(144.0 / border - 1e-6).hidden_area, 0.0) << "what was tried in vain is too much already";
}

TEST_F(FrontierReportTest, WhatIsBehindTightWaysIsNamedAndMoreThanALittleOfItIsTooMuch) {
  SetAside(0, 12, AsideReason::kOutOfSight);
  // The room with its walls, but for the far end.
  const double much = 0.01 * (62.0 * 14.0 * 14.0 - 14.0 * 14.0) * 0.01;  // [m^2]
  const auto end = [&](double area) {
    const std::vector<TightWay> ways = {{.place_W = {1.0, 2.0, 3.0}, .area = 0.25 * area},
                                        {.place_W = {4.0, 5.0, 6.0}, .area = 0.75 * area}};
    return EndingWithNothingLeft(knowledge_, 1.0, search_, {}, ways);
  };
  EXPECT_EQ(end(much - 1e-6).outcome, Outcome::kComplete);
  const Ending ending = end(much + 1e-6);
  EXPECT_EQ(ending.outcome, Outcome::kTooMuchUnknown);
  ASSERT_EQ(ending.tight_ways.size(), 2U);
  EXPECT_EQ(ending.tight_ways[0].place_W, Eigen::Vector3d(4.0, 5.0, 6.0)) << "the larger one first";
  EXPECT_NEAR(ending.tight_ways[1].area, 0.25 * much, 1e-6);
}

TEST_F(FrontierReportTest, WhatWasNeverSetAsideWasTooSmall) {
  const Ending ending = EndingWithNothingLeft(knowledge_, 0.0, search_);
  EXPECT_EQ(ending.outcome, Outcome::kComplete);
  ASSERT_EQ(ending.missed.size(), 1U);
  EXPECT_EQ(ending.missed.front().reason, AsideReason::kTooSmall);
  EXPECT_NEAR(ending.missed.front().area, 1.44, 1e-9);
}

TEST_F(FrontierReportTest, WhatWasNotWorthThePathIsNotAmongWhatWasTooSmall) {
  Candidate candidate = CandidateOf(0, 6.05, 5.5);
  test::ForEachVoxel({{60, 0, 0}, {61, 3, 12}},
                     [&](const VoxelIndex& i) { candidate.cluster.unknowns.push_back(i); });
  search_.Take({candidate});
  const Ending ending = EndingWithNothingLeft(knowledge_, 0.0, search_);
  EXPECT_EQ(ending.left_frontiers, 1U);
  EXPECT_NEAR(ending.left_area, 0.36, 1e-9);
  EXPECT_NEAR(ending.missed_area, 1.08, 1e-9);
  const double border = 4.0 * 60.0 * 12.0 + 2.0 * 144.0;
  EXPECT_NEAR(ending.missed_share, 108.0 / border, 1e-12);
  EXPECT_NEAR(ShareOfBorder(knowledge_, search_.candidates()), 36.0 / border, 1e-12);
}

}  // namespace
}  // namespace thalweg::explorer
