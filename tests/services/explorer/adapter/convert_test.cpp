#include "services/explorer/adapter/convert.h"

#include <gtest/gtest.h>

namespace thalweg::explorer {
namespace {

TEST(AsideReasonOnTheWire, IsTheSameReasonAfterwards) {
  for (int k = 0; k <= static_cast<int>(AsideReason::kTooSmall); ++k) {
    const auto reason = static_cast<AsideReason>(k);
    EXPECT_EQ(FromIdl(ToIdl(reason)), reason);
    EXPECT_EQ(AsideReasonNamed(NameOf(reason)), reason);
  }
}

TEST(AsideReasonOnTheWire, IsNoneIfNoReasonHasThatNumber) {
  EXPECT_EQ(FromIdl(static_cast<thalweg_msgs::msg::AsideReason>(99)), AsideReason::kNone);
  EXPECT_FALSE(AsideReasonNamed("just because"));
}

}  // namespace
}  // namespace thalweg::explorer
