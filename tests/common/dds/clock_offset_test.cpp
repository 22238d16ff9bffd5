#include "common/dds/clock_offset.h"

#include <gtest/gtest.h>

namespace thalweg::dds {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

/// What is found of messages every 100 ms for 6 s, each of which takes 2 to 400 ms.
std::optional<Duration> OffsetFound(Duration reader_ahead) {
  ClockOffset offset;
  std::optional<Duration> found;
  for (int k = 0; k <= 60; ++k) {
    const Duration delay = k % 7 == 3 ? Duration(2ms) : Duration(400ms);
    const auto now = ClockOffset::SteadyTime{} + k * 100ms;
    if (const auto result = offset.Add(delay + reader_ahead, now)) found = result;
  }
  return found;
}

TEST(ClockOffset, IsTheLeastTimeThatAMessageTakes) {
  EXPECT_EQ(OffsetFound(600ms), Duration(602ms));
  EXPECT_EQ(OffsetFound(-600ms), Duration(-598ms));
}

TEST(ClockOffset, SmallOnesAndSlowMessagesAreNoOffset) {
  EXPECT_FALSE(OffsetFound(0ms));
  EXPECT_FALSE(OffsetFound(90ms));
  EXPECT_FALSE(OffsetFound(-90ms));
}

TEST(ClockOffset, AFewMessagesTellNothing) {
  ClockOffset offset;
  for (int k = 0; k < 4; ++k)
    EXPECT_FALSE(offset.Add(std::chrono::hours(1), ClockOffset::SteadyTime{} + k * 10s)) << k;
}

}  // namespace
}  // namespace thalweg::dds
