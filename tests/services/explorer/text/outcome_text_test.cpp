#include "services/explorer/text/outcome_text.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

namespace thalweg::explorer {
namespace {

const std::map<Outcome, std::string> kOutcomeTexts = {
    {Outcome::kComplete, "complete"},
    {Outcome::kTooMuchUnknown, "incomplete: too much stayed unknown"},
    {Outcome::kNothingReachable, "nothing reachable"},
    {Outcome::kNoFreeSpace, "no free space in sight"},
    {Outcome::kTimeBudget, "time budget"},
    {Outcome::kDistanceBudget, "distance budget"},
    {Outcome::kNoPathHome, "no path home"},
    {Outcome::kOperator, "ended by the operator"},
    {Outcome::kDoesNotApply, "the strategy does not apply"},
    {Outcome::kCannotGoOn, "the strategy cannot go on"},
};

const std::map<AsideReason, std::string> kReasonTexts = {
    {AsideReason::kLookedAt, "looked at and stayed unknown"},
    {AsideReason::kVisited, "visited without progress"},
    {AsideReason::kOutOfSight, "seen from no reachable place"},
    {AsideReason::kLostThere, "lost or stopped on the way there"},
    {AsideReason::kNoDepth, "nothing was measured there: too little texture, or too far?"},
    {AsideReason::kIgnored, "ignored by the operator"},
    {AsideReason::kTooSmall, "too small to matter"},
    {AsideReason::kNoRoom, "no room to turn to it"},
};

TEST(OutcomeText, OfEveryOutcomeIsItsOwn) {
  std::set<std::string_view> texts;
  for (int k = 0; k <= static_cast<int>(Outcome::kCannotGoOn); ++k) {
    const auto outcome = static_cast<Outcome>(k);
    ASSERT_TRUE(kOutcomeTexts.contains(outcome)) << NameOf(outcome);
    EXPECT_EQ(OutcomeText(outcome), kOutcomeTexts.at(outcome));
    texts.insert(OutcomeText(outcome));
  }
  EXPECT_EQ(texts.size(), kOutcomeTexts.size());
}

TEST(EndingText, HasTheReasonThatAStrategyGives) {
  EXPECT_EQ(EndingText({.outcome = Outcome::kCannotGoOn, .why = "no way"}),
            "the strategy cannot go on: no way");
  EXPECT_EQ(EndingText({.outcome = Outcome::kComplete, .why = "no rift is left"}),
            "complete, no rift is left");
  EXPECT_EQ(EndingText({.outcome = Outcome::kComplete}), "complete");
}

TEST(OutcomeTextDeathTest, OfNoOutcomeIsABug) {
  EXPECT_DEATH(OutcomeText(static_cast<Outcome>(200)), "");
}

TEST(EndingText, IsThatOfItsOutcomeUntilTheRobotIsHomeWithinItsBudget) {
  for (const auto& [outcome, text] : kOutcomeTexts) {
    EXPECT_EQ(EndingText({.outcome = outcome}), text);
    EXPECT_EQ(EndingText({.outcome = outcome, .home_within_budget = true}), "home within the " + text);
  }
}

TEST(EndingText, SaysNothingOfWhatElseTheEndingTells) {
  EXPECT_EQ(EndingText({.outcome = Outcome::kTooMuchUnknown,
                        .missed = {{AsideReason::kVisited, 1.44}},
                        .missed_area = 1.44,
                        .left_frontiers = 3,
                        .doubtful_voxels = 2}),
            "incomplete: too much stayed unknown");
}

TEST(AsideText, OfEveryReasonIsItsOwn) {
  std::set<std::string> texts;
  for (const AsideReason reason : kAsideReasons) {
    ASSERT_TRUE(kReasonTexts.contains(reason)) << NameOf(reason);
    EXPECT_EQ(AsideText(reason, /*doubtful=*/false), kReasonTexts.at(reason));
    texts.insert(AsideText(reason, false));
  }
  EXPECT_EQ(texts.size(), kReasonTexts.size());
}

TEST(AsideText, OfDoubtfulVoxelsBeginsWithThatAndDoesNotCallThemUnknown) {
  for (const AsideReason reason : kAsideReasons) {
    const std::string text = AsideText(reason, /*doubtful=*/true);
    const bool looked_at = reason == AsideReason::kLookedAt;
    EXPECT_EQ(text, "doubtful: " + (looked_at ? "looked at and stayed so" : kReasonTexts.at(reason)));
    EXPECT_EQ(text.find("unknown"), std::string::npos) << text;
  }
}

TEST(AsideText, WithoutAReasonSaysOnlyWhetherTheyAreDoubtful) {
  EXPECT_EQ(AsideText(AsideReason::kNone, /*doubtful=*/false), "");
  EXPECT_EQ(AsideText(AsideReason::kNone, /*doubtful=*/true), "doubtful");
}

}  // namespace
}  // namespace thalweg::explorer
