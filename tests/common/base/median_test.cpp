#include "common/base/median.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

TEST(Median, IsTheMiddleValueInOrder) {
  EXPECT_EQ(Median({5.0, 1.0, 9.0}), 5.0);
  EXPECT_EQ(Median({7.0}), 7.0);
}

TEST(Median, OfAnEvenNumberIsTheUpperOfTheTwo) {
  EXPECT_EQ(Median({4.0, 1.0, 3.0, 2.0}), 3.0);
}

TEST(Median, OfNoneIsZero) {
  EXPECT_EQ(Median({}), 0.0);
}

}  // namespace
}  // namespace thalweg
