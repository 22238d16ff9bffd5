#include "common/base/stamp_order.h"

#include <gtest/gtest.h>

#include "tests/support/at_second.h"

namespace thalweg {
namespace {

using test::AtSecond;
using Verdict = StampOrder::Verdict;

TEST(StampOrder, AcceptsWhatIsLaterAndRefusesRepetitions) {
  StampOrder order;
  EXPECT_EQ(order.newest(), std::nullopt);
  EXPECT_EQ(order.Judge(AtSecond(5.0)), Verdict::kLater);
  EXPECT_EQ(order.Judge(AtSecond(5.0)), Verdict::kNotLater);
  EXPECT_EQ(order.Judge(AtSecond(4.1)), Verdict::kNotLater);
  EXPECT_EQ(order.newest(), AtSecond(5.0));
  EXPECT_EQ(order.Judge(AtSecond(5.1)), Verdict::kLater);
  EXPECT_EQ(order.newest(), AtSecond(5.1));
}

TEST(StampOrder, BeginsAgainWhenTheClockWasRestarted) {
  StampOrder order;
  order.Judge(AtSecond(100.0));
  EXPECT_EQ(order.Judge(AtSecond(99.0)), Verdict::kRestarted);
  EXPECT_EQ(order.newest(), AtSecond(99.0));
  EXPECT_EQ(order.Judge(AtSecond(99.5)), Verdict::kLater);
  EXPECT_EQ(order.Judge(AtSecond(0.0)), Verdict::kRestarted);
  EXPECT_EQ(order.Judge(AtSecond(0.1)), Verdict::kLater);
}

TEST(StampOrder, NoticesAnotherStreamsRestart) {
  StampOrder order;
  EXPECT_FALSE(order.IsRestartedAt(AtSecond(0.0)));
  order.Judge(AtSecond(100.0));
  EXPECT_FALSE(order.IsRestartedAt(AtSecond(99.5)));
  EXPECT_TRUE(order.IsRestartedAt(AtSecond(2.0)));
  order.Judge(AtSecond(2.1));
  EXPECT_FALSE(order.IsRestartedAt(AtSecond(2.0)));
}

}  // namespace
}  // namespace thalweg
