#include "services/link/core/clock_offset.h"

#include <gtest/gtest.h>

namespace thalweg::link {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

TEST(ClockOffset, IsExactWhereBothWaysTakeEquallyLong) {
  ClockOffset clock;
  EXPECT_FALSE(clock.estimate());
  // Ahead by 100 s, 20 ms each way, 5 ms between there.
  clock.Add(1s, 101s + 20ms, 101s + 25ms, 1s + 45ms);
  ASSERT_TRUE(clock.estimate());
  EXPECT_EQ(clock.estimate()->offset, 100s);
  EXPECT_EQ(clock.estimate()->delay, 40ms);
}

TEST(ClockOffset, IsWrongByAtMostHalfOfTheDelayAndTakesTheBestExchange) {
  ClockOffset clock;
  for (const Duration there : {500ms, 0ms, 100ms}) {  // there takes long, back takes none
    clock.Add(1s, 1s + there - 3s, 1s + there - 3s, 1s + there);
    EXPECT_LE(std::abs(Seconds(clock.estimate()->offset + 3s)), Seconds(clock.estimate()->delay) / 2.0);
  }
  EXPECT_EQ(clock.estimate()->offset, -3s);
}

TEST(ClockOffset, ForgetsExchangesOfLongAgo) {
  ClockOffset clock;
  clock.Add(0s, 5s, 5s, 0s);
  for (int k = 0; k < 16; ++k) clock.Add(0s, 7s, 7s, 10ms);
  EXPECT_EQ(clock.estimate()->offset, 7s - 5ms);
}

TEST(ClockOffset, IgnoresTimesThatNoClocksShow) {
  ClockOffset clock;
  clock.Add(10s, 0s, 5s, 11s);  // longer there than the whole round trip
  EXPECT_FALSE(clock.estimate());
}

}  // namespace
}  // namespace thalweg::link
