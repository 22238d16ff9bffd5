#include "services/explorer/core/scan_pace.h"

#include <gtest/gtest.h>

namespace thalweg::explorer {
namespace {

using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;

TEST(ScanPace, BeforeTheFirstScanNothingIsMissed) {
  EXPECT_FALSE(ScanPace().Silent(Time{1000s}));
}

TEST(ScanPace, ASilenceIsASecondOrThreeScansThatAreMissing) {
  for (const Duration interval : {Duration(20ms), Duration(200ms), Duration(2s)}) {
    ScanPace pace;
    Time now{100s};
    for (int scan = 0; scan < 30; ++scan) pace.Note(now += interval);
    const Duration limit = std::max<Duration>(1s, 3 * interval);
    EXPECT_FALSE(pace.Silent(now + limit)) << interval.count();
    EXPECT_TRUE(pace.Silent(now + limit + 1ms)) << interval.count();
    pace.ShiftTimes(50s);
    EXPECT_FALSE(pace.Silent(now - 50s + limit)) << interval.count();
    EXPECT_TRUE(pace.Silent(now - 50s + limit + 1ms)) << interval.count();
  }
}

TEST(ScanPace, AfterTheFirstScanItWaitsForThreeSecondsForTheSecond) {
  ScanPace pace;
  pace.Note(Time{100s});
  EXPECT_FALSE(pace.Silent(Time{103s}));
  EXPECT_TRUE(pace.Silent(Time{103s + 1ms}));
}

TEST(ScanPace, OneLongSilenceMakesTheNextNoLonger) {
  ScanPace pace;
  Time now{100s};
  for (int scan = 0; scan < 5; ++scan) pace.Note(now += 200ms);
  pace.Note(now += 60s);
  pace.Note(now += 200ms);
  EXPECT_TRUE(pace.Silent(now + 1001ms));
}

TEST(ScanPace, FollowsASensorThatBecomesSlower) {
  ScanPace pace;
  Time now{100s};
  for (int scan = 0; scan < 20; ++scan) pace.Note(now += 100ms);
  EXPECT_TRUE(pace.Silent(now + 2s));
  for (int scan = 0; scan < 6; ++scan) pace.Note(now += 1s);
  EXPECT_FALSE(pace.Silent(now + 2s));
}

}  // namespace
}  // namespace thalweg::explorer
