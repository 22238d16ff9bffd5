#include "services/cli/report/evaluation_progress.h"

#include <gtest/gtest.h>

namespace thalweg::cli {
namespace {

using evaluator::Outcome;

Outcome CutOffRun() {
  Outcome outcome;
  outcome.scenario = "room";
  outcome.strategy = "closest";
  outcome.seed = 3;
  outcome.end.kind = evaluator::RunEnd::Kind::kCutOff;
  outcome.distance = 12.34;
  outcome.coverage = 0.9;
  return outcome;
}

TEST(ProgressBar, ARunIsALineWhereNoneCanBeWrittenOver) {
  const ProgressBar bar(10, 0, /*terminal=*/false);
  EXPECT_EQ(bar.Beginning(), "");
  // Six runs at 10 s each are left.
  EXPECT_EQ(bar.After(CutOffRun(), 4, 40.0),
            "[============                  ] 4/10, 1:00 left  room closest start 3: cut off, 12.3 m, "
            "coverage 90.0 %\n");
}

TEST(ProgressBar, ATerminalsLineIsWrittenOverUntilTheLastRun) {
  const ProgressBar bar(2, 0, /*terminal=*/true);
  EXPECT_EQ(bar.After(CutOffRun(), 1, 10.0),
            "\r\33[K[===============               ] 1/2, 0:10 left  room closest start 3: cut off, 12.3 m, "
            "coverage 90.0 %");
  EXPECT_EQ(bar.After(CutOffRun(), 2, 20.0).back(), '\n');
}

TEST(ProgressBar, WhatWasMadeBeforeTookNoTimeNow) {
  const ProgressBar bar(10, 2, /*terminal=*/false);
  EXPECT_EQ(bar.Beginning(), "2 of 10 runs were made before\n");
  // Two runs took 20 s, six are left.
  EXPECT_NE(bar.After(CutOffRun(), 4, 20.0).find(" 4/10, 1:00 left "), std::string::npos);
}

TEST(TourText, NamesTheLengthToEachCoverageThatATourReaches) {
  Outcome outcome = CutOffRun();
  outcome.optimum.emplace();
  outcome.optimum->places = 5;
  outcome.optimum->to[0].length = 30.2;
  EXPECT_EQ(TourText(outcome, false),
            "room start 3: offline tours 30.2 m to 95 %, - m to 99 %, - m to 99.5 %, - m to 99.8 %");
  outcome.optimum->out_of_time = true;
  outcome.optimum->iterations = 7;
  EXPECT_EQ(
      TourText(outcome, true),
      "room start 3: offline tours 30.2 m to 95 %, - m to 99 %, - m to 99.5 %, - m to 99.8 %; out of time "
      "after 7 iterations (found before)");
}

TEST(TourText, SaysThatARobotDoesNotFit) {
  Outcome outcome = CutOffRun();
  outcome.optimum.emplace();
  EXPECT_EQ(TourText(outcome, false), "room start 3: no room for a tour at the start");
}

}  // namespace
}  // namespace thalweg::cli
