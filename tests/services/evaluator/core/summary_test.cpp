#include "services/evaluator/core/summary.h"

#include <gtest/gtest.h>

namespace thalweg::evaluator {
namespace {

/// Coverage grows in proportion to the path length until it is 1 at `end`.
Outcome Straight(const std::string& scenario, const std::string& strategy, int run, double end) {
  Outcome outcome;
  outcome.scenario = scenario;
  outcome.strategy = strategy;
  outcome.run = run;
  outcome.seed = run + 1;
  outcome.distance = end;
  outcome.coverage = 1.0;
  for (int k = 0; k <= 1000; ++k) {
    outcome.progress.push_back({.time = 0.1 * k, .distance = end * k / 1000.0, .coverage = k / 1000.0});
  }
  outcome.timings["plan"] = {.count = 10, .p50_ms = 5.0, .p95_ms = 20.0, .max_ms = 30.0};
  return outcome;
}

TEST(Summarize, AveragesTheFiguresOfSurfacesOverTheRunsThatHaveThem) {
  std::vector<Outcome> outcomes(3);
  outcomes[0].surface = {.observable = 10.0, .seen = 0.9, .f_near = 0.5};
  outcomes[1].surface = {.observable = 20.0, .seen = 0.7, .f_near = 1.0};
  const std::vector<Summary> summaries = Summarize(outcomes);
  ASSERT_TRUE(summaries.at(0).surface);
  EXPECT_NEAR(summaries[0].surface->observable, 15.0, 1e-12);
  EXPECT_NEAR(summaries[0].surface->seen, 0.8, 1e-12);
  EXPECT_NEAR(summaries[0].surface->f_near, 0.75, 1e-12);
  outcomes.resize(1);
  outcomes[0].surface.reset();
  EXPECT_FALSE(Summarize(outcomes).at(0).surface);
}

TEST(Outcome, PathToACoverageIsWhereItWasReached) {
  const Outcome outcome = Straight("room", "closest", 0, 40.0);
  EXPECT_NEAR(PathTo(outcome, 0.5).value(), 20.0, 0.05);
  EXPECT_NEAR(PathTo(outcome, 0.95).value(), 38.0, 0.05);
  Outcome half = outcome;
  half.progress.resize(501);
  EXPECT_FALSE(PathTo(half, 0.95));
}

TEST(Outcome, TimeToACoverageIsWhenItWasReached) {
  const Outcome outcome = Straight("room", "closest", 0, 40.0);
  EXPECT_NEAR(TimeTo(outcome, 0.5).value(), 50.0, 0.15);
  EXPECT_FALSE(TimeTo(outcome, 1.5));
}

TEST(Summarize, SplitsTheTimeOfRunsAndKeepsTheirGreatestRates) {
  std::vector<Outcome> outcomes = {Straight("room", "closest", 0, 40.0),
                                   Straight("room", "closest", 1, 60.0)};
  outcomes[0].duration = outcomes[1].duration = 100.0;
  outcomes[0].motion = {.moving = 60.0,
                        .turning = 30.0,
                        .standing = 10.0,
                        .stops = 4,
                        .most_speed = 1.0,
                        .most_acceleration = 2.0,
                        .most_jerk = 7.0};
  outcomes[1].motion = {.moving = 40.0,
                        .turning = 50.0,
                        .standing = 10.0,
                        .stops = 8,
                        .most_speed = 1.5,
                        .most_acceleration = 1.0};
  const Summary summary = Summarize(outcomes).front();
  EXPECT_NEAR(summary.moving.mean, 50.0, 1e-12);
  EXPECT_NEAR(summary.turning.mean, 40.0, 1e-12);
  EXPECT_NEAR(summary.standing.mean, 10.0, 1e-12);
  EXPECT_NEAR(summary.stops.mean, 6.0, 1e-12);
  EXPECT_NEAR(summary.speed.mean, 0.5, 1e-12);
  EXPECT_NEAR(summary.time_to.at(95).mean, 95.0, 0.15);
  EXPECT_EQ(summary.motion.most_speed, 1.5);
  EXPECT_EQ(summary.motion.most_acceleration, 2.0);
  EXPECT_EQ(summary.motion.most_jerk, 7.0);
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
  outcomes.back().end.kind = RunEnd::Kind::kCutOff;
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
  EXPECT_EQ(summaries[0].plan().p95_ms, 20.0);
  EXPECT_EQ(summaries[3].scenario, "hall");
  EXPECT_EQ(summaries[3].completed, 2U);
  EXPECT_EQ(summaries[3].collisions, 2);
  EXPECT_EQ(summaries[3].least_clearance, -0.1);
  ASSERT_EQ(summaries[3].ends.size(), 2U);
  EXPECT_EQ(NameOf(summaries[3].ends[0].end), "complete");
  EXPECT_EQ(summaries[3].ends[0].runs, 2);
  EXPECT_EQ(NameOf(summaries[3].ends[1].end), "cut_off");
  EXPECT_EQ(summaries[3].ends[1].runs, 1);
}

TEST(Summarize, CountsEndsAtHomeWithinTheBudgetApart) {
  std::vector<Outcome> outcomes(3);
  for (Outcome& outcome : outcomes) outcome.end.ending.outcome = explorer::Outcome::kTimeBudget;
  outcomes.back().end.ending.home_within_budget = true;
  const std::vector<Summary> summaries = Summarize(outcomes);
  ASSERT_EQ(summaries.size(), 1U);
  ASSERT_EQ(summaries[0].ends.size(), 2U);
  EXPECT_EQ(summaries[0].ends[0].runs, 2);
  EXPECT_TRUE(summaries[0].ends[1].end.ending.home_within_budget);
}

TEST(Summarize, TakesTheAreaOverTheMedianPathOfTheFirstStrategy) {
  std::vector<Outcome> outcomes;
  for (int run = 0; run < 3; ++run) {
    outcomes.push_back(Straight("room", "closest", run, 10.0 * (run + 1)));
    outcomes.push_back(Straight("room", "other", run, 40.0));
  }
  const std::vector<Summary> summaries = Summarize(outcomes);
  ASSERT_EQ(summaries.size(), 2U);
  EXPECT_EQ(summaries[0].horizon, 20.0);
  EXPECT_EQ(summaries[1].horizon, 20.0);
  // Coverage rises to 1 at 10, 20 and 30 m, with a horizon of 20 m.
  EXPECT_NEAR(summaries[0].area.mean, (0.75 + 0.5 + 1.0 / 3.0) / 3.0, 0.001);
  EXPECT_NEAR(summaries[1].area.mean, 0.25, 0.001);
}

TEST(Summarize, FrontiersSetAsideAreMeansOfAllRunsAndStagesMediansOfTheirs) {
  std::vector<Outcome> outcomes;
  for (int run = 0; run < 3; ++run) outcomes.push_back(Straight("room", "closest", run, 10.0));
  outcomes[0].set_aside = {{explorer::AsideReason::kTooSmall, false, 6, 9}};
  outcomes[1].set_aside = {{explorer::AsideReason::kTooSmall, false, 3, 3},
                           {explorer::AsideReason::kVisited, true, 1, 30}};
  outcomes[0].timings["flood"] = {.count = 1, .p50_ms = 1.0, .p95_ms = 7.0, .max_ms = 50.0};
  outcomes[1].timings["flood"] = {.count = 1, .p50_ms = 2.0, .p95_ms = 8.0, .max_ms = 40.0};
  outcomes[2].timings["flood"] = {.count = 1, .p50_ms = 9.0, .p95_ms = 9.0, .max_ms = 30.0};
  const Summary summary = Summarize(outcomes).at(0);
  EXPECT_NEAR(summary.set_aside.at("too small to matter").clusters, 3.0, 1e-12);
  EXPECT_NEAR(summary.set_aside.at("too small to matter").voxels, 4.0, 1e-12);
  EXPECT_NEAR(summary.set_aside.at("doubtful: visited without progress").voxels, 10.0, 1e-12);
  EXPECT_EQ(summary.stages.at("flood").p50_ms, 2.0);
  EXPECT_EQ(summary.stages.at("flood").p95_ms, 8.0);
  EXPECT_EQ(summary.stages.at("flood").max_ms, 50.0);
}

TEST(Summarize, PathsAreRelatedToTheToursFromTheirStartsByTheirGeometricMean) {
  std::vector<Outcome> outcomes;
  for (const double end : {40.0, 10.0}) {
    outcomes.push_back(Straight("room", "closest", static_cast<int>(outcomes.size()), end));
    OfflineTours& tours = outcomes.back().optimum.emplace();
    tours.to[0] = {.length = 9.5, .coverage = 0.95, .stops = 3};
    tours.to[1] = {.length = 9.9, .coverage = 0.99, .stops = 4};
  }
  outcomes[1].progress.resize(980);  // never reaches 99 %
  const auto of = Summarize(outcomes).at(0).of_optimum;
  ASSERT_EQ(of.size(), 4U);
  EXPECT_NEAR(of.at("95").ratio, 2.0, 0.005) << "of 4 and 1";
  EXPECT_EQ(of.at("95").runs, 2U);
  EXPECT_NEAR(of.at("95").tour, 9.5, 1e-12);
  EXPECT_NEAR(of.at("99").ratio, 4.0, 0.005);
  EXPECT_EQ(of.at("99").runs, 1U);
  EXPECT_EQ(of.at("99.8").runs, 0U) << "there is no tour";
  EXPECT_TRUE(Summarize(std::vector{Straight("room", "closest", 0, 40.0)}).at(0).of_optimum.empty());
  outcomes[0].optimum->to[0].stops = 0;
  EXPECT_FALSE(OfOptimumAt(outcomes[0], 0)) << "what is seen from the start takes no path";
}

TEST(Summarize, SharesOfTheTailAreOfAllTailsTogether) {
  std::vector<Outcome> outcomes(3, Straight("room", "closest", 0, 40.0));
  outcomes[0].tail = {
      .begins = 10.0,
      .journeys = {{4.0, 10, Tail::Kind::kPassedBy, true}, {1.0, 30, Tail::Kind::kNew, false}},
      .other = 1.0};
  outcomes[1].tail = {.begins = 20.0, .journeys = {{2.0, 20, Tail::Kind::kInVain, true}}};
  outcomes[2].tail = Tail{};  // never got there
  const Summary summary = Summarize(outcomes).at(0);
  ASSERT_TRUE(summary.tail);
  EXPECT_EQ(summary.tail->runs, 2U);
  EXPECT_NEAR(summary.tail->begins, 15.0, 1e-12);
  EXPECT_NEAR(summary.tail->length, 4.0, 1e-12);
  EXPECT_NEAR(summary.tail->journeys, 1.5, 1e-12);
  EXPECT_NEAR(summary.tail->median, 2.0, 1e-12);
  EXPECT_NEAR(summary.tail->long_share, 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(summary.tail->long_length_share, 0.75, 1e-12);
  EXPECT_NEAR(summary.tail->target, 20.0, 1e-12);
  EXPECT_NEAR(summary.tail->small_length_share, 0.75, 1e-12);
  EXPECT_NEAR(summary.tail->length_shares.at(Tail::Kind::kPassedBy), 0.5, 1e-12);
  EXPECT_NEAR(summary.tail->in_sight_length_share, 0.5, 1e-12);
  EXPECT_NEAR(summary.tail->length_shares.at(Tail::Kind::kNew), 0.125, 1e-12);
  EXPECT_NEAR(summary.tail->length_shares.at(Tail::Kind::kInVain), 0.25, 1e-12);
  EXPECT_NEAR(summary.tail->length_shares.at(Tail::Kind::kAtHand), 0.0, 1e-12);
  EXPECT_FALSE(Summarize(std::vector{Straight("room", "closest", 0, 40.0)}).at(0).tail);
}

TEST(Compare, OverAllWorldsEachCountsTheSame) {
  std::vector<Outcome> outcomes;
  for (int run = 0; run < 8; ++run) outcomes.push_back(Straight("room", "closest", run, 10.0));
  for (int run = 0; run < 8; ++run) outcomes.push_back(Straight("room", "other", run, 5.0));
  for (int run = 0; run < 6; ++run) outcomes.push_back(Straight("hall", "closest", run, 10.0));
  for (int run = 0; run < 6; ++run) outcomes.push_back(Straight("hall", "other", run, 20.0));
  for (int run = 0; run < 2; ++run) outcomes.push_back(Straight("maze", "closest", run, 10.0));
  for (int run = 0; run < 2; ++run) outcomes.push_back(Straight("maze", "other", run, run == 0 ? 5.0 : 20.0));
  const std::vector<Comparison> comparisons = Compare(outcomes, "closest");
  ASSERT_EQ(comparisons.size(), 4U);
  const Comparison& all = comparisons.back();
  EXPECT_EQ(all.scenario, "");
  EXPECT_EQ(all.to_end.worlds, 3U);
  EXPECT_EQ(all.to_end.pairs, 16U);
  EXPECT_NEAR(all.to_end.mean, 1.0, 1e-9) << "half, double, and once each";
  EXPECT_EQ(all.decided_to_end.shorter, 1U);
  EXPECT_EQ(all.decided_to_end.longer, 1U) << "the maze is undecided";
}

TEST(Compare, FewerThanSixPairsDecideNothing) {
  for (const int pairs : {5, 6}) {
    std::vector<Outcome> outcomes;
    for (int run = 0; run < pairs; ++run) outcomes.push_back(Straight("room", "closest", run, 10.0));
    for (int run = 0; run < pairs; ++run) outcomes.push_back(Straight("room", "other", run, 5.0));
    EXPECT_EQ(Compare(outcomes, "closest").at(0).decided_to_end.shorter, pairs == 6 ? 1U : 0U);
  }
}

TEST(Compare, PairsRunsOfTheSameStartAndLeavesOutTheIncomplete) {
  std::vector<Outcome> outcomes;
  for (int run = 0; run < 4; ++run) {
    outcomes.push_back(Straight("room", "closest", run, 10.0 * (run + 1)));
    outcomes.push_back(Straight("room", "other", run, 5.0 * (run + 1)));
  }
  outcomes[1].end.kind = RunEnd::Kind::kCutOff;
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
