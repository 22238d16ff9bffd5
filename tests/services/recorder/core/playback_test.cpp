#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

TEST(PlaybackClock, AfterASeekItGoesOnFromThereOrStandsThere) {
  PlaybackClock clock(Time{10s}, 2.0);
  clock.Seek(kBegin, Time{50s});
  EXPECT_EQ(clock.At(kBegin + 9s), Time{50s});
  clock.Resume(kBegin + 10s);
  EXPECT_EQ(clock.At(kBegin + 11s), Time{52s});
  for (const Time to : {Time{20s}, Time{90s}}) {
    clock.Seek(kBegin + 12s, to);
    EXPECT_EQ(clock.At(kBegin + 12s), to);
    EXPECT_EQ(clock.At(kBegin + 15s), to + 6s);
    EXPECT_EQ(clock.DueAt(to + 6s), kBegin + 15s);
  }
}

TEST(PlaybackClock, TheTimeIsThePiecewiseIntegralOfTheRate) {
  PlaybackClock clock(Time{10s}, 1.0);
  clock.Resume(kBegin);
  Time expected{10s};
  PlaybackClock::Steady now = kBegin;
  for (const double rate : {4.0, 0.25, 1.0, 0.5}) {
    EXPECT_EQ(clock.At(now), expected) << "a change of rate does not move it";
    clock.SetRate(now, rate);
    EXPECT_EQ(clock.rate(), rate);
    EXPECT_EQ(clock.At(now), expected);
    EXPECT_EQ(clock.DueAt(expected + 1s), now + FromSeconds(1.0 / rate));
    now += 8s;
    expected += FromSeconds(8.0 * rate);
  }
  clock.Pause(now);
  clock.SetRate(now + 5s, 2.0);
  EXPECT_EQ(clock.At(now + 9s), expected);
  clock.Resume(now + 10s);
  EXPECT_EQ(clock.At(now + 11s), expected + 2s);
}

TEST(PlaybackClock, ARateIsFiniteAndPositive) {
  for (const double rate : {0.001, 0.25, 1.0, 1000.0}) EXPECT_TRUE(PlaybackClock::IsRate(rate)) << rate;
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double rate : {0.0, -1.0, 1e-300, 1e300, infinity, -infinity, std::nan("")}) {
    EXPECT_FALSE(PlaybackClock::IsRate(rate)) << rate;
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
