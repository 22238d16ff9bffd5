#include "services/explorer/core/outcome.h"

#include <gtest/gtest.h>

namespace thalweg::explorer {
namespace {

constexpr Outcome kEveryOutcome[] = {
    Outcome::kComplete,     Outcome::kTooMuchUnknown, Outcome::kNothingReachable, Outcome::kNoFreeSpace,
    Outcome::kTimeBudget,   Outcome::kDistanceBudget, Outcome::kNoPathHome,       Outcome::kOperator,
    Outcome::kDoesNotApply, Outcome::kCannotGoOn,
};

TEST(Outcome, IsReadBackFromItsName) {
  for (const Outcome outcome : kEveryOutcome) EXPECT_EQ(OutcomeNamed(NameOf(outcome)), outcome);
  for (const char* name : {"", "Complete", "time budget", "enough"}) EXPECT_FALSE(OutcomeNamed(name)) << name;
}

TEST(PauseReason, IsReadBackFromItsName) {
  for (int k = 0; k <= static_cast<int>(PauseReason::kRestarted); ++k) {
    const auto reason = static_cast<PauseReason>(k);
    EXPECT_EQ(PauseReasonNamed(NameOf(reason)), reason);
  }
  for (const char* name : {"", "Operator", "by the operator"}) EXPECT_FALSE(PauseReasonNamed(name)) << name;
}

TEST(Ending, SucceedsWhenAllWasSeenOrABudgetBroughtTheRobotHome) {
  int succeeded = 0;
  for (const Outcome outcome : kEveryOutcome) succeeded += Ending{.outcome = outcome}.succeeded() ? 1 : 0;
  EXPECT_EQ(succeeded, 1);
  EXPECT_TRUE(Ending{.outcome = Outcome::kComplete}.succeeded());
  EXPECT_TRUE((Ending{.outcome = Outcome::kTimeBudget, .home_within_budget = true}.succeeded()));
}

}  // namespace
}  // namespace thalweg::explorer
