#include "common/base/stamp_pairs.h"

#include <gtest/gtest.h>

#include <string>

namespace thalweg {
namespace {

Time At(int seconds) {
  return Time{std::chrono::seconds(seconds)};
}
using Pair = std::pair<std::string, std::string>;

TEST(StampPairs, TheHalvesMayComeInAnyOrder) {
  StampPairs<std::string> pairs;
  EXPECT_FALSE(pairs.AddLeft(At(1), "l1"));
  EXPECT_EQ(pairs.AddRight(At(1), "r1"), Pair("l1", "r1"));
  EXPECT_FALSE(pairs.AddRight(At(2), "r2"));
  EXPECT_EQ(pairs.AddLeft(At(2), "l2"), Pair("l2", "r2"));
  EXPECT_EQ(pairs.TakeDropped(), 0U);
}

TEST(StampPairs, CountsHalvesThatANewerPairHasOvertaken) {
  StampPairs<std::string> pairs;
  pairs.AddLeft(At(1), "l1");
  pairs.AddLeft(At(2), "l2");
  pairs.AddRight(At(3), "r3");
  EXPECT_TRUE(pairs.AddLeft(At(3), "l3"));
  EXPECT_EQ(pairs.TakeDropped(), 2U);
  EXPECT_FALSE(pairs.AddRight(At(2), "r2"));  // late
  EXPECT_EQ(pairs.TakeDropped(), 1U);
  EXPECT_EQ(pairs.TakeDropped(), 0U);
}

TEST(StampPairs, KeepsNoMoreThanItsCapacity) {
  StampPairs<std::string> pairs(2);
  for (int i = 1; i <= 5; ++i) pairs.AddLeft(At(i), "l");
  EXPECT_EQ(pairs.TakeDropped(), 3U);
  EXPECT_FALSE(pairs.AddRight(At(3), "r"));
  EXPECT_TRUE(pairs.AddRight(At(4), "r"));
}

TEST(StampPairs, PairsAgainAfterTheClockWasRestarted) {
  StampPairs<std::string> pairs;
  EXPECT_FALSE(pairs.ClearIfRestarted(At(9)));
  pairs.AddLeft(At(9), "l9");
  pairs.AddRight(At(9), "r9");
  EXPECT_FALSE(pairs.ClearIfRestarted(At(9) - std::chrono::milliseconds(500))) << "late, no restart";
  EXPECT_TRUE(pairs.ClearIfRestarted(At(1)));
  EXPECT_FALSE(pairs.AddLeft(At(1), "l1"));
  EXPECT_FALSE(pairs.ClearIfRestarted(At(1)));
  EXPECT_EQ(pairs.AddRight(At(1), "r1"), Pair("l1", "r1"));
  EXPECT_EQ(pairs.TakeDropped(), 0U);
}

}  // namespace
}  // namespace thalweg
