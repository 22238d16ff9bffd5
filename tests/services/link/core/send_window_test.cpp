#include "services/link/core/send_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

namespace thalweg::link {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

/// A line that carries `rate` bytes a second and delays each way, with a sender that always has more.
struct Line {
  double rate;
  Duration delay;
  SendWindow window;
  Duration now = 1s;
  Duration free_at = 1s;  ///< When the line has sent all that it was given.
  std::uint64_t sequence = 0;
  std::deque<std::pair<Duration, std::uint64_t>> acknowledgments = {};
  std::size_t delivered = 0;
  Duration longest_queue{0};

  void Run(Duration duration) {
    constexpr std::size_t kBytes = 1300;
    for (const Duration end = now + duration; now < end; now += 1ms) {
      for (; !acknowledgments.empty() && acknowledgments.front().first <= now; acknowledgments.pop_front()) {
        window.OnAcknowledged(acknowledgments.front().second, now);
        delivered += kBytes;
      }
      while (!window.full()) {
        window.OnSent(++sequence, kBytes, now);
        free_at = std::max(free_at, now) + FromSeconds(kBytes / rate);
        longest_queue = std::max(longest_queue, free_at - now);
        acknowledgments.emplace_back(free_at + 2 * delay, sequence);
      }
    }
  }
};

TEST(SendWindow, FillsALineWithoutALongQueue) {
  for (const double rate : {62'500.0, 250'000.0}) {  // 0.5 and 2 Mbit/s
    Line line{.rate = rate, .delay = 20ms, .window = {}};
    line.Run(10s);
    line.delivered = 0;
    line.longest_queue = 0s;
    line.Run(20s);
    EXPECT_GT(static_cast<double>(line.delivered) / 20.0, 0.85 * rate) << rate;
    EXPECT_LT(Seconds(line.longest_queue), 0.25) << rate;
  }
}

TEST(SendWindow, FollowsALineThatBecomesSlower) {
  Line line{.rate = 1e6, .delay = 5ms, .window = {}};
  line.Run(10s);
  line.rate = 62'500.0;
  line.Run(10s);
  line.longest_queue = 0s;
  line.Run(10s);
  EXPECT_LT(Seconds(line.longest_queue), 0.25);
}

TEST(SendWindow, StopsWhenNothingIsAcknowledgedAndKeepsAReserveForWhatIsUrgent) {
  SendWindow window;
  std::uint64_t sequence = 0;
  while (!window.full()) window.OnSent(++sequence, 1000, 1s);
  EXPECT_LE(window.in_flight(), window.window() + 1000);
  EXPECT_FALSE(window.exhausted());
  while (!window.exhausted()) window.OnSent(++sequence, 100, 1s);
  EXPECT_EQ(window.OldestAge(4s), 3s);
  window.OnAcknowledged(sequence, 4s);
  EXPECT_EQ(window.in_flight(), 0U);
  EXPECT_EQ(window.OldestAge(5s), 0s);
}

}  // namespace
}  // namespace thalweg::link
