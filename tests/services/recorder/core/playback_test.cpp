#include <gtest/gtest.h>

#include "services/recorder/core/message_queue.h"
#include "services/recorder/core/playback_clock.h"
#include "services/recorder/core/topic_pattern.h"

namespace thalweg::recorder {
namespace {

using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;
const PlaybackClock::Steady kBegin{100s};

TEST(PlaybackClock, StandsStillUntilItIsResumedAndWhilePaused) {
  PlaybackClock clock(Time{10s}, 1.0);
  EXPECT_EQ(clock.At(kBegin + 5s), Time{10s});
  clock.Resume(kBegin + 5s);
  EXPECT_EQ(clock.At(kBegin + 7s), Time{12s});
  clock.Pause(kBegin + 8s);
  EXPECT_EQ(clock.At(kBegin + 20s), Time{13s});
  clock.Resume(kBegin + 20s);
  EXPECT_EQ(clock.At(kBegin + 21s), Time{14s});
}

TEST(PlaybackClock, AMessageIsDueWhenTheClockReachesItsTimeAtAnyRate) {
  for (const double rate : {0.5, 1.0, 4.0}) {
    PlaybackClock clock(Time{10s}, rate);
    clock.Resume(kBegin);
    EXPECT_EQ(clock.DueAt(Time{14s}), kBegin + FromSeconds(4.0 / rate));
    EXPECT_EQ(clock.At(clock.DueAt(Time{14s})), Time{14s});
  }
}

TEST(MessageQueue, DropsWhatDoesNotFitAndKeepsTheOrder) {
  MessageQueue queue(10);
  EXPECT_TRUE(queue.TryPush({.sequence = 1, .payload = std::vector<std::uint8_t>(20)}));  // fits when empty
  EXPECT_FALSE(queue.TryPush({.sequence = 2, .payload = std::vector<std::uint8_t>(1)}));
  EXPECT_EQ(queue.Pop(0s)->sequence, 1U);
  EXPECT_TRUE(queue.TryPush({.sequence = 3, .payload = std::vector<std::uint8_t>(5)}));
  EXPECT_TRUE(queue.TryPush({.sequence = 4, .payload = std::vector<std::uint8_t>(5)}));
  EXPECT_FALSE(queue.TryPush({.sequence = 5, .payload = std::vector<std::uint8_t>(1)}));
  queue.Close();
  EXPECT_FALSE(queue.TryPush({.sequence = 6, .payload = {}}));
  EXPECT_FALSE(queue.exhausted());
  EXPECT_EQ(queue.Pop(0s)->sequence, 3U);
  EXPECT_EQ(queue.Pop(0s)->sequence, 4U);
  EXPECT_FALSE(queue.Pop(10s).has_value());  // closed: does not wait
  EXPECT_TRUE(queue.exhausted());
}

TEST(TopicPattern, AStarStandsForAnything) {
  EXPECT_TRUE(Matches("odometry", "/odometry"));
  EXPECT_TRUE(Matches("/odometry", "odometry"));
  EXPECT_FALSE(Matches("odometry", "odometry/status"));
  EXPECT_TRUE(Matches("stereo/*", "stereo/left/image_raw"));
  EXPECT_TRUE(Matches("*/left/*", "stereo/left/image_raw"));
  EXPECT_TRUE(Matches("*", ""));
  EXPECT_TRUE(Matches("a*b*c", "axxbyybc"));
  EXPECT_FALSE(Matches("a*b*c", "axxcyyb"));
  EXPECT_FALSE(Matches("", "a"));
}

}  // namespace
}  // namespace thalweg::recorder
