#include "services/gateway/core/log_budget.h"

#include <gtest/gtest.h>

namespace thalweg::gateway {
namespace {

using std::chrono_literals::operator""ms;

TEST(LogBudget, OfAFloodAFewLinesAndThenOneASecondRemainAndTheOthersAreCounted) {
  LogBudget budget;
  std::uint64_t logged = 0;
  std::uint64_t left_out = 0;
  for (Duration now = {}; now < 100'000ms; now += 1ms) {
    const auto before = budget.Spend(now);
    if (!before) continue;
    ++logged;
    left_out += *before;
  }
  EXPECT_NEAR(static_cast<double>(logged), LogBudget::kAtOnce + 99.0, 1.0);
  EXPECT_GT(logged + left_out, 98'000U) << "all but those after the last line";
  EXPECT_LE(logged + left_out, 100'000U);
}

TEST(LogBudget, RareLinesAreAllLogged) {
  LogBudget budget;
  for (int n = 0; n < 100; ++n) EXPECT_EQ(budget.Spend(n * 1000ms), 0U);
}

}  // namespace
}  // namespace thalweg::gateway
