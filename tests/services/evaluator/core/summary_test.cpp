#include "services/evaluator/core/summary.h"

#include <gtest/gtest.h>

namespace thalweg::evaluator {
namespace {

/// Coverage grows in proportion to the way until it is 1 at `end`.
Outcome Straight(const std::string& scenario, const std::string& strategy, int run, double end) {
  Outcome outcome;
  outcome.scenario = scenario;
  outcome.strategy = strategy;
  outcome.run = run;
  outcome.seed = run + 1;
  outcome.stop_reason = "complete";
  outcome.distance = end;
  outcome.coverage = 1.0;
  for (int k = 0; k <= 1000; ++k) {
    outcome.progress.push_back({.time = 0.1 * k, .distance = end * k / 1000.0, .coverage = k / 1000.0});
  }
  outcome.timings["plan"] = {.count = 10, .p50_ms = 5.0, .p95_ms = 20.0, .max_ms = 30.0};
  return outcome;
}

TEST(Outcome, PathToACoverageIsWhereItWasReached) {
  const Outcome outcome = Straight("room", "closest", 0, 40.0);
  EXPECT_NEAR(PathTo(outcome, 0.5).value(), 20.0, 0.05);
  EXPECT_NEAR(PathTo(outcome, 0.95).value(), 38.0, 0.05);
  Outcome half = outcome;
  half.progress.resize(501);
  EXPECT_FALSE(PathTo(half, 0.95));
}

TEST(Outcome, AreaUnderCoverageOfAStraightRiseIsHalf) {
  const Outcome outcome = Straight("room", "closest", 0, 40.0);
  EXPECT_NEAR(AreaUnderCoverage(outcome, 40.0), 0.5, 0.001);
  EXPECT_NEAR(AreaUnderCoverage(outcome, 20.0), 0.25, 0.001);
  EXPECT_NEAR(AreaUnderCoverage(outcome, 80.0), 0.75, 0.001) << "it stays at 1 after the end";
}

TEST(Summarize, KeepsScenariosAndStrategiesApart) {
  std::vector<Outcome> outcomes;
  for (int run = 0; run < 3; ++run) {
    for (const char* scenario : {"room", "hall"}) {
      outcomes.push_back(Straight(scenario, "closest", run, 10.0 + run));
      outcomes.push_back(Straight(scenario, "other", run, 20.0 + run));
    }
  }
  outcomes.back().stop_reason = "cut off";
  outcomes.back().collisions = 2;
  outcomes.back().least_clearance = -0.1;
  const std::vector<Summary> summaries = Summarize(outcomes);
  ASSERT_EQ(summaries.size(), 4U);
  EXPECT_EQ(summaries[0].scenario, "room");
  EXPECT_EQ(summaries[0].strategy, "closest");
  EXPECT_EQ(summaries[0].runs, 3U);
  EXPECT_EQ(summaries[0].completed, 3U);
  EXPECT_NEAR(summaries[0].path.mean, 11.0, 1e-12);
  EXPECT_NEAR(summaries[0].path.deviation, 1.0, 1e-12);
  EXPECT_NEAR(summaries[0].path_to.at(50).mean, 5.5, 0.02);
  EXPECT_EQ(summaries[0].plan_ms_p95, 20.0);
  EXPECT_EQ(summaries[3].scenario, "hall");
  EXPECT_EQ(summaries[3].completed, 2U);
  EXPECT_EQ(summaries[3].collisions, 2);
  EXPECT_EQ(summaries[3].least_clearance, -0.1);
  EXPECT_EQ(summaries[3].stop_reasons.at("cut off"), 1);
}

TEST(Compare, PairsRunsOfTheSameStartAndLeavesOutTheIncomplete) {
  std::vector<Outcome> outcomes;
  for (int run = 0; run < 4; ++run) {
    outcomes.push_back(Straight("room", "closest", run, 10.0 * (run + 1)));
    outcomes.push_back(Straight("room", "other", run, 5.0 * (run + 1)));
  }
  outcomes[1].stop_reason = "cut off";
  const std::vector<Comparison> comparisons = Compare(outcomes, "closest");
  ASSERT_EQ(comparisons.size(), 1U);
  EXPECT_EQ(comparisons[0].strategy, "other");
  EXPECT_EQ(comparisons[0].to_end.pairs, 3U);
  EXPECT_NEAR(comparisons[0].to_end.mean, 0.5, 1e-12);
  EXPECT_EQ(comparisons[0].to_95.pairs, 4U);
  EXPECT_NEAR(comparisons[0].to_95.mean, 0.5, 1e-12);
}

}  // namespace
}  // namespace thalweg::evaluator
