#include "services/explorer/core/outcome.h"

#include <gtest/gtest.h>

#include <set>

namespace thalweg::explorer {
namespace {

constexpr Outcome kAll[] = {
    Outcome::kComplete,   Outcome::kTooMuchUnknown, Outcome::kNothingReachable, Outcome::kNoFreeSpace,
    Outcome::kTimeBudget, Outcome::kDistanceBudget, Outcome::kNoPathHome,
};

TEST(Ending, IsReadBackFromItsText) {
  for (const Outcome outcome : kAll) {
    for (const bool home : {false, true}) {
      if (home && !IsBudget(outcome)) continue;
      const Ending ending{.outcome = outcome, .home_within_budget = home};
      const std::optional<Ending> back = EndingFrom(ToText(ending));
      ASSERT_TRUE(back) << ToText(ending);
      EXPECT_EQ(back->outcome, outcome);
      EXPECT_EQ(back->home_within_budget, home);
    }
  }
  for (const char* text : {"", "Complete", "home within the complete", "home within the ", "enough"}) {
    EXPECT_FALSE(EndingFrom(text)) << text;
  }
}

TEST(Ending, SucceedsWhenAllWasSeenOrABudgetBroughtTheRobotHome) {
  int succeeded = 0;
  for (const Outcome outcome : kAll) succeeded += Ending{.outcome = outcome}.succeeded() ? 1 : 0;
  EXPECT_EQ(succeeded, 1);
  EXPECT_TRUE(Ending{.outcome = Outcome::kComplete}.succeeded());
  EXPECT_TRUE((Ending{.outcome = Outcome::kTimeBudget, .home_within_budget = true}.succeeded()));
}

TEST(Interruption, EachHasWordsOfItsOwn) {
  std::set<std::string_view> texts;
  int count = 0;
  for (const Interruption why :
       {Interruption::kPathBlocked, Interruption::kNotFacingPassage, Interruption::kTimeForHome,
        Interruption::kDistanceForHome, Interruption::kTargetSeen, Interruption::kClockReset,
        Interruption::kLost, Interruption::kControllerStopped, Interruption::kMapReplaced}) {
    texts.insert(ToText(why));
    ++count;
  }
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(count));
}

}  // namespace
}  // namespace thalweg::explorer
