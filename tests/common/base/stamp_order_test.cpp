#include "common/base/stamp_order.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

using Verdict = StampOrder::Verdict;

Time At(double seconds) {
  return Time{FromSeconds(seconds)};
}

TEST(StampOrder, AcceptsWhatIsLaterAndRefusesRepetitions) {
  StampOrder order;
  EXPECT_EQ(order.newest(), std::nullopt);
  EXPECT_EQ(order.Judge(At(5.0)), Verdict::kLater);
  EXPECT_EQ(order.Judge(At(5.0)), Verdict::kNotLater);
  EXPECT_EQ(order.Judge(At(4.1)), Verdict::kNotLater);
  EXPECT_EQ(order.newest(), At(5.0));
  EXPECT_EQ(order.Judge(At(5.1)), Verdict::kLater);
  EXPECT_EQ(order.newest(), At(5.1));
}

TEST(StampOrder, BeginsAgainWhenTheClockWasRestarted) {
  StampOrder order;
  order.Judge(At(100.0));
  EXPECT_EQ(order.Judge(At(99.0)), Verdict::kRestarted);
  EXPECT_EQ(order.newest(), At(99.0));
  EXPECT_EQ(order.Judge(At(99.5)), Verdict::kLater);
  EXPECT_EQ(order.Judge(At(0.0)), Verdict::kRestarted);
  EXPECT_EQ(order.Judge(At(0.1)), Verdict::kLater);
}

TEST(StampOrder, NoticesAnotherStreamsRestart) {
  StampOrder order;
  EXPECT_FALSE(order.IsRestartedAt(At(0.0)));
  order.Judge(At(100.0));
  EXPECT_FALSE(order.IsRestartedAt(At(99.5)));
  EXPECT_TRUE(order.IsRestartedAt(At(2.0)));
  order.Judge(At(2.1));
  EXPECT_FALSE(order.IsRestartedAt(At(2.0)));
}

}  // namespace
}  // namespace thalweg
