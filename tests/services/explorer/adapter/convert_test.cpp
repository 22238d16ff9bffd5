#include "services/explorer/adapter/convert.h"

#include <gtest/gtest.h>

namespace thalweg::explorer {
namespace {

TEST(AsideReasonOnTheWire, IsTheSameReasonAfterwards) {
  for (int k = 0; k <= static_cast<int>(AsideReason::kNoRoom); ++k) {
    const auto reason = static_cast<AsideReason>(k);
    EXPECT_EQ(FromIdl(ToIdl(reason)), reason);
    EXPECT_EQ(AsideReasonNamed(NameOf(reason)), reason);
  }
}

TEST(OutcomeOnTheWire, IsTheSameOutcomeAfterwards) {
  for (const Outcome outcome : kOutcomes) EXPECT_EQ(FromIdl(ToIdl(outcome)), outcome) << NameOf(outcome);
}

TEST(OutcomeOnTheWire, IsNoneWhileExploringAndForAnOutsideExplorersOwnReason) {
  EXPECT_FALSE(FromIdl(thalweg_msgs::msg::OUTCOME_NONE));
  EXPECT_FALSE(FromIdl(thalweg_msgs::msg::OUTCOME_OTHER));
  EXPECT_FALSE(FromIdl(static_cast<thalweg_msgs::msg::ExplorationOutcome>(99)));
}

TEST(AsideReasonOnTheWire, IsNoneIfNoReasonHasThatNumber) {
  EXPECT_EQ(FromIdl(static_cast<thalweg_msgs::msg::AsideReason>(99)), AsideReason::kNone);
  EXPECT_FALSE(AsideReasonNamed("just because"));
}

}  // namespace
}  // namespace thalweg::explorer
