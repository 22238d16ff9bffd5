#include "common/base/stamp_gaps.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/at_second.h"

namespace thalweg {
namespace {

using test::AtSecond;

TEST(StampGaps, CountsWhatIsMissingFromARegularStream) {
  StampGaps gaps;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-0.02, 0.02);
  std::bernoulli_distribution is_lost(0.1);
  std::size_t lost = 0;
  std::size_t counted = 0;
  for (int k = 0; k < 2000; ++k) {
    if (k > 20 && k < 1999 && is_lost(random)) {
      ++lost;
      continue;
    }
    counted += gaps.Add(AtSecond(0.2 * k + jitter(random)));
  }
  EXPECT_GT(lost, 100U);
  EXPECT_EQ(counted, lost);
}

TEST(StampGaps, SaysNothingOfAStreamWithoutGapsBeforeItKnowsThePeriodOrWhenTimeJumpsBack) {
  StampGaps gaps;
  EXPECT_EQ(gaps.Add(AtSecond(100.0)), 0U);
  EXPECT_EQ(gaps.Add(AtSecond(200.0)), 0U);
  for (int k = 0; k < 100; ++k) EXPECT_EQ(gaps.Add(AtSecond(300.0 + 0.1 * k)), 0U) << k;
  EXPECT_EQ(gaps.Add(AtSecond(1.0)), 0U);
  EXPECT_EQ(gaps.Add(AtSecond(1.1)), 0U);
}

TEST(StampGaps, FollowsAPeriodThatChanges) {
  StampGaps gaps;
  for (int k = 0; k < 40; ++k) gaps.Add(AtSecond(0.1 * k));
  std::size_t counted = 0;
  for (int k = 0; k < 60; ++k) counted = gaps.Add(AtSecond(10.0 + 0.3 * k));
  EXPECT_EQ(counted, 0U) << "0.3 s is the period now";
}

}  // namespace
}  // namespace thalweg
