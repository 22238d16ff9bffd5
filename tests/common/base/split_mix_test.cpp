#include "common/base/split_mix.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

// The first numbers of the generator's reference implementation from the seed 1234567.
TEST(SplitMix, GivesTheNumbersOfItsReference) {
  SplitMix random{1234567};
  EXPECT_EQ(random.Next(), 6457827717110365317U);
  EXPECT_EQ(random.Next(), 3203168211198807973U);
  EXPECT_EQ(random.Next(), 9817491932198370423U);
}

TEST(SplitMix, StaysWithinBounds) {
  SplitMix random;
  for (int n = 0; n < 1000; ++n) {
    EXPECT_LT(random.Below(7), 7U);
    const double share = random.Share();
    EXPECT_GE(share, 0.0);
    EXPECT_LT(share, 1.0);
  }
}

}  // namespace
}  // namespace thalweg
