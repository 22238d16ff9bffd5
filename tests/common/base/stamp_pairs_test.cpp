#include "common/base/stamp_pairs.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/at_second.h"

namespace thalweg {
namespace {

using test::AtSecond;
using Pair = std::pair<std::string, std::string>;

TEST(StampPairs, TheHalvesMayComeInAnyOrder) {
  StampPairs<std::string> pairs;
  EXPECT_FALSE(pairs.AddLeft(AtSecond(1), "l1"));
  EXPECT_EQ(pairs.AddRight(AtSecond(1), "r1"), Pair("l1", "r1"));
  EXPECT_FALSE(pairs.AddRight(AtSecond(2), "r2"));
  EXPECT_EQ(pairs.AddLeft(AtSecond(2), "l2"), Pair("l2", "r2"));
  EXPECT_EQ(pairs.TakeDropped(), 0U);
}

TEST(StampPairs, CountsHalvesThatANewerPairHasOvertaken) {
  StampPairs<std::string> pairs;
  pairs.AddLeft(AtSecond(1), "l1");
  pairs.AddLeft(AtSecond(2), "l2");
  pairs.AddRight(AtSecond(3), "r3");
  EXPECT_TRUE(pairs.AddLeft(AtSecond(3), "l3"));
  EXPECT_EQ(pairs.TakeDropped(), 2U);
  EXPECT_FALSE(pairs.AddRight(AtSecond(2), "r2"));  // late
  EXPECT_EQ(pairs.TakeDropped(), 1U);
  EXPECT_EQ(pairs.TakeDropped(), 0U);
}

TEST(StampPairs, KeepsNoMoreThanItsCapacity) {
  StampPairs<std::string> pairs(2);
  for (int i = 1; i <= 5; ++i) pairs.AddLeft(AtSecond(i), "l");
  EXPECT_EQ(pairs.TakeDropped(), 3U);
  EXPECT_FALSE(pairs.AddRight(AtSecond(3), "r"));
  EXPECT_TRUE(pairs.AddRight(AtSecond(4), "r"));
}

TEST(StampPairs, PairsAgainAfterTheClockWasRestarted) {
  StampPairs<std::string> pairs;
  EXPECT_FALSE(pairs.ClearIfRestarted(AtSecond(9)));
  pairs.AddLeft(AtSecond(9), "l9");
  pairs.AddRight(AtSecond(9), "r9");
  EXPECT_FALSE(pairs.ClearIfRestarted(AtSecond(9) - std::chrono::milliseconds(500))) << "late, no restart";
  EXPECT_TRUE(pairs.ClearIfRestarted(AtSecond(1)));
  EXPECT_FALSE(pairs.AddLeft(AtSecond(1), "l1"));
  EXPECT_FALSE(pairs.ClearIfRestarted(AtSecond(1)));
  EXPECT_EQ(pairs.AddRight(AtSecond(1), "r1"), Pair("l1", "r1"));
  EXPECT_EQ(pairs.TakeDropped(), 0U);
}

}  // namespace
}  // namespace thalweg
