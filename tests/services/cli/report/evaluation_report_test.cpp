#include "services/cli/report/evaluation_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "services/cli/report/evaluation_tables.h"

namespace thalweg::cli {
namespace {

using evaluator::Outcome;
using testing::HasSubstr;
using testing::Not;

Outcome Ended(const std::string& scenario, const std::string& strategy, int run, double distance) {
  Outcome outcome;
  outcome.scenario = scenario;
  outcome.strategy = strategy;
  outcome.run = run;
  outcome.seed = run + 1;
  outcome.distance = distance;
  outcome.duration = 2.0 * distance;
  outcome.coverage = 0.999;
  outcome.agreement = 0.98;
  outcome.least_clearance = 0.06;
  outcome.progress = {{.time = 0.0, .distance = 0.0, .coverage = 0.4},
                      {.time = distance, .distance = 0.5 * distance, .coverage = 0.96},
                      {.time = 2.0 * distance, .distance = distance, .coverage = 0.999}};
  outcome.timings["plan"] = {.count = 10, .p50_ms = 5.0, .p95_ms = 20.0, .max_ms = 30.0};
  outcome.timings["flood"] = {.count = 10, .p50_ms = 1.5, .p95_ms = 2.5, .max_ms = 3.5};
  outcome.set_aside = {{explorer::AsideReason::kLookedAt, false, 2, 30}};
  return outcome;
}

std::vector<Outcome> TwoStrategiesInTwoWorlds() {
  std::vector<Outcome> outcomes;
  for (const char* scenario : {"room", "hall"}) {
    for (int run = 0; run < 7; ++run) outcomes.push_back(Ended(scenario, "closest", run, 40.0 + run));
    for (int run = 0; run < 7; ++run) outcomes.push_back(Ended(scenario, "other", run, 30.0 + run));
  }
  outcomes.back().end.kind = evaluator::RunEnd::Kind::kCutOff;
  return outcomes;
}

TEST(EvaluationTables, EachRowHasACellAColumn) {
  const std::vector<Outcome> outcomes = TwoStrategiesInTwoWorlds();
  for (const Table& table : {SummaryTable(outcomes), TimeTable(outcomes), ComparisonTable(outcomes),
                             StageTable(outcomes), EndTable(outcomes), SetAsideTable(outcomes)}) {
    EXPECT_FALSE(table.rows.empty()) << table.header.back();
    for (const Table::Row& row : table.rows)
      EXPECT_EQ(row.size(), table.header.size()) << table.header.back();
    for (const std::size_t column : table.terminal_columns) EXPECT_LT(column, table.header.size());
  }
}

TEST(EvaluationTables, TheTableOfTimesSaysWhereItWent) {
  Outcome outcome = Ended("room", "closest", 0, 40.0);
  outcome.motion = {.moving = 50.0, .turning = 20.0, .standing = 10.0, .stops = 7, .most_turn_rate = 1.0};
  const Table table = TimeTable(std::vector{outcome});
  const auto cell = [&](const std::string& column) {
    const auto at = std::ranges::find(table.header, column);
    return at == table.header.end()
               ? "no such column"
               : table.rows.at(0).at(static_cast<std::size_t>(at - table.header.begin()));
  };
  EXPECT_EQ(cell("time [s]"), "80.0");
  EXPECT_EQ(cell("s to 95 %"), "40.0");
  EXPECT_EQ(cell("turning [s]"), "20.0");
  EXPECT_EQ(cell("stops"), "7.0");
  EXPECT_EQ(cell("speed [m/s]"), "0.50");
  EXPECT_EQ(cell("most [deg/s]"), "57");
}

TEST(EvaluationTables, TheLastComparisonIsOverAllWorlds) {
  const Table table = ComparisonTable(TwoStrategiesInTwoWorlds());
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_EQ(table.rows.back().front(), "all");
  EXPECT_THAT(table.rows.back().at(2), HasSubstr("n 14; shorter in 2, longer in 0 of 2"));
  EXPECT_THAT(table.rows.back().at(3), HasSubstr("n 13;")) << "one did not complete";
}

TEST(EvaluationText, ReportsWhatItsColumnsMean) {
  const std::string text = EvaluationText(TwoStrategiesInTwoWorlds());
  for (const char* column : {"path, sd", "area", "coverage", "collisions, nearest", "plan", "ratio"}) {
    EXPECT_THAT(text, HasSubstr(std::string("\n  ") + column)) << text;
  }
}

TEST(EvaluationText, BreaksWhatItsColumnsMeanIntoLinesOfATerminal) {
  std::istringstream lines(EvaluationText(TwoStrategiesInTwoWorlds()));
  int continued = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  ")) continue;
    EXPECT_LE(line.size(), 120U) << line;
    if (line.starts_with("    ")) ++continued;
  }
  EXPECT_GT(continued, 0);
}

TEST(EvaluationText, RelatesPathsToTheOptimumAndTellsOfTailsWhereTheyAreKnown) {
  std::vector<Outcome> outcomes = TwoStrategiesInTwoWorlds();
  EXPECT_TRUE(OptimumTable(outcomes).rows.empty());
  EXPECT_TRUE(TailTable(outcomes).rows.empty());
  EXPECT_THAT(EvaluationText(outcomes), Not(HasSubstr("optimum")));
  for (Outcome& outcome : outcomes) {
    outcome.optimum.emplace().to[0] = {.length = 0.25 * outcome.distance, .coverage = 0.95, .stops = 2};
    outcome.tail = {.begins = 0.5 * outcome.distance,
                    .journeys = {{0.5 * outcome.distance, 12, evaluator::Tail::Kind::kAtHand, false}}};
  }
  for (const Table& table : {OptimumTable(outcomes), TailTable(outcomes)}) {
    ASSERT_EQ(table.rows.size(), 4U);
    for (const Table::Row& row : table.rows) EXPECT_EQ(row.size(), table.header.size());
    for (const std::size_t column : table.terminal_columns) EXPECT_LT(column, table.header.size());
  }
  EXPECT_EQ(OptimumTable(outcomes).rows[0].at(6), "2.00") << "95 % at half of the path";
  EXPECT_EQ(OptimumTable(outcomes).rows[0].at(7), "-");
  EXPECT_EQ(TailTable(outcomes).rows[0].back(), "100 %");
  const std::string text = EvaluationText(outcomes);
  for (const char* word : {"of optimum 95 %", "upper bound", "at hand", "in vain"}) {
    EXPECT_THAT(text, HasSubstr(word));
  }
}

TEST(EvaluationText, NamesWhatWasSetForAllRuns) {
  const std::vector<Outcome> outcomes = TwoStrategiesInTwoWorlds();
  const std::vector<std::string> overrides = {"mapper.voxel_size_m=0.05", "explorer.bold=true"};
  EXPECT_EQ(EvaluationText(outcomes, overrides),
            "all runs with mapper.voxel_size_m=0.05, explorer.bold=true\n\n" + EvaluationText(outcomes));
}

TEST(EvaluationText, OneStrategyAloneIsComparedWithNothing) {
  const std::vector<Outcome> outcomes = {Ended("room", "closest", 0, 10.0)};
  EXPECT_THAT(EvaluationText(outcomes), Not(HasSubstr("path of")));
  EXPECT_THAT(EvaluationText(outcomes), Not(HasSubstr("ratio:")));
}

TEST(CoverageCurves, AreDrawnOverDistanceAndOverTime) {
  const std::vector<Outcome> outcomes = TwoStrategiesInTwoWorlds();
  const cv::Mat both = DrawCoverageCurves(outcomes, "room");
  std::vector<Outcome> slower = outcomes;
  for (Outcome& outcome : slower) {
    if (outcome.strategy != "other") continue;
    outcome.duration *= 2.0;
    for (Outcome::Progress& progress : outcome.progress) progress.time *= 2.0;
  }
  const cv::Mat other = DrawCoverageCurves(slower, "room");
  const cv::Rect left(0, 0, both.cols / 2, both.rows);
  const cv::Rect right(both.cols / 2, 0, both.cols / 2, both.rows);
  EXPECT_EQ(cv::norm(both(left), other(left)), 0.0) << "distance";
  EXPECT_GT(cv::norm(both(right), other(right)), 0.0) << "time";
}

}  // namespace
}  // namespace thalweg::cli
