#include "services/cli/report/evaluation_verdict.h"

#include <gtest/gtest.h>

namespace thalweg::cli {
namespace {

using evaluator::Outcome;
using evaluator::PairedRatio;

PairedRatio Ratio(std::size_t pairs, double mean, double low, double high, std::size_t worlds = 1) {
  return {.worlds = worlds, .pairs = pairs, .mean = mean, .interval = {low, high}, .p = 0.01};
}

std::string TextOn(const PairedRatio& ratio) {
  return VerdictOn(ratio, "flow", "closest", "to 95 % coverage").text;
}

TEST(Verdict, IsShorterOrLongerOnlyIfTheWholeIntervalIs) {
  EXPECT_EQ(TextOn(Ratio(30, 0.93, 0.89, 0.97)),
            "flow is 7 % shorter to 95 % coverage than closest [3 % to 11 % shorter], over 30 pairs.");
  EXPECT_EQ(
      TextOn(Ratio(30, 1.72, 1.5, 2.1, 3)),
      "flow is 72 % longer to 95 % coverage than closest [50 % to 110 % longer], over 30 pairs in 3 worlds.");
  EXPECT_EQ(TextOn(Ratio(30, 0.95, 0.88, 1.02)),
            "No difference shown between flow and closest to 95 % coverage: 5 % shorter [12 % shorter to 2 % "
            "longer], "
            "over 30 pairs.");
  EXPECT_EQ(VerdictOn(Ratio(30, 0.93, 0.89, 0.97), "a", "b", "").kind, Verdict::Kind::kShorter);
  EXPECT_EQ(VerdictOn(Ratio(30, 1.72, 1.5, 2.1), "a", "b", "").kind, Verdict::Kind::kLonger);
  EXPECT_EQ(VerdictOn(Ratio(30, 0.95, 0.88, 1.02), "a", "b", "").kind, Verdict::Kind::kUndecided);
}

TEST(Verdict, FewerThanSixPairsDecideNothingHoweverFarApart) {
  EXPECT_EQ(TextOn(Ratio(4, 0.5, 0.4, 0.6)),
            "flow was 50 % shorter to 95 % coverage than closest, but four pairs cannot decide.");
  EXPECT_EQ(TextOn(Ratio(1, 1.004, 1.004, 1.004)),
            "flow was 0.4 % longer to 95 % coverage than closest, but one pair cannot decide.");
  EXPECT_EQ(VerdictOn(Ratio(5, 0.5, 0.4, 0.6), "a", "b", "").kind, Verdict::Kind::kUndecided);
  EXPECT_EQ(VerdictOn(Ratio(6, 0.5, 0.4, 0.6), "a", "b", "").kind, Verdict::Kind::kShorter);
}

TEST(Verdict, AnIntervalThatTheSignTestDoesNotConfirmDecidesNothing) {
  PairedRatio ratio = Ratio(6, 0.71, 0.6, 0.82, 2);
  ratio.p = 0.1976;
  EXPECT_EQ(TextOn(ratio),
            "flow was 29 % shorter to 95 % coverage than closest, but 6 pairs cannot decide (p 0.20).");
}

TEST(Verdict, SaysSoWhenThereIsNothingToCompare) {
  EXPECT_EQ(TextOn(Ratio(0, 0, 0, 0)),
            "flow and closest cannot be compared to 95 % coverage: from no start did both get there.");
  EXPECT_EQ(VerdictsOn({}).front().text, "No run was made.");
}

TEST(Verdict, CountsRunsThatDidNotCompleteOrTouchedSomething) {
  std::vector<Outcome> outcomes(3);
  EXPECT_EQ(VerdictsOn(outcomes).back().text, "All 3 runs completed, none touched anything.");
  EXPECT_EQ(VerdictsOn(outcomes).back().kind, Verdict::Kind::kFine);
  outcomes[0].end.kind = evaluator::RunEnd::Kind::kCutOff;
  outcomes[1].collisions = 2;
  EXPECT_EQ(VerdictsOn(outcomes).back().text, "1 of 3 runs did not complete, 1 touched a surface.");
  EXPECT_EQ(VerdictsOn(outcomes).back().kind, Verdict::Kind::kTrouble);
  const std::vector<Outcome> one(1);
  EXPECT_EQ(VerdictsOn(one).back().text, "The run completed, and touched nothing.");
  EXPECT_EQ(VerdictsOn(std::span(outcomes).first(1)).back().text,
            "The run did not complete, and touched nothing.");
  EXPECT_EQ(VerdictsOn(std::span(outcomes).subspan(1, 1)).back().text,
            "The run completed, and touched a surface.");
}

}  // namespace
}  // namespace thalweg::cli
