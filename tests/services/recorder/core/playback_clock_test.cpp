#include "services/recorder/core/playback_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

TEST(PlaybackClock, StandsAtWhatIsNextWhileThatIsLateAndGoesOnFromThere) {
  PlaybackClock clock(Time{10s}, 100.0);
  clock.Resume(kBegin);
  clock.SetNext(Time{12s});
  EXPECT_EQ(clock.At(kBegin + 10ms), Time{11s}) << "nothing is late yet";
  EXPECT_EQ(clock.At(kBegin + 1s), Time{12s});
  EXPECT_EQ(clock.DueAt(Time{12s}), kBegin + 20ms) << "how late it is does not change when it is due";
  clock.SetRate(kBegin + 1s, 1.0);
  clock.SetNext(Time{60s});
  EXPECT_EQ(clock.At(kBegin + 3s), Time{14s});
  clock.SetNext(Time{14s});
  clock.Pause(kBegin + 9s);
  EXPECT_EQ(clock.At(kBegin + 20s), Time{14s});
  clock.Resume(kBegin + 20s);
  clock.SetNext(Time{60s});
  EXPECT_EQ(clock.At(kBegin + 21s), Time{15s});
  clock.Seek(kBegin + 21s, Time{70s});
  EXPECT_EQ(clock.At(kBegin + 22s), Time{71s}) << "what was next is not any more";
}

TEST(PlaybackClock, ARateIsFiniteAndPositive) {
  for (const double rate : {0.001, 0.25, 1.0, 1000.0}) EXPECT_TRUE(PlaybackClock::IsRate(rate)) << rate;
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double rate : {0.0, -1.0, 1e-300, 1e300, infinity, -infinity, std::nan("")}) {
    EXPECT_FALSE(PlaybackClock::IsRate(rate)) << rate;
  }
}

}  // namespace
}  // namespace thalweg::recorder
