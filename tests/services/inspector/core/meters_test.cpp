#include "services/inspector/core/meters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/support/at_second.h"

namespace thalweg::inspector {
namespace {

using test::AtSecond;

TEST(Meters, TheRateOfAJitteringPublisherIsItsOwnWithinOnePercent) {
  std::mt19937 random(1);
  std::normal_distribution<double> jitter(0.0, 0.004);
  for (const double hz : {1.0, 20.0, 100.0}) {
    RateMeter meter(10000);
    const int count = 2000;
    for (int k = 0; k < count; ++k) meter.Add(AtSecond(100 + k / hz + std::abs(jitter(random))));
    EXPECT_NEAR(meter.hz(), hz, 0.01 * hz);
  }
}

TEST(Meters, TheSpreadIsThatOfThePeriods) {
  RateMeter meter(10);
  EXPECT_FALSE(meter.Report());
  for (const double t : {0.0, 0.1, 0.3, 0.6}) meter.Add(AtSecond(t));
  // Periods 0.1, 0.2, 0.3: their mean 0.2, their variance 0.02 / 3.
  EXPECT_NEAR(meter.hz(), 5.0, 1e-9);
  EXPECT_EQ(*meter.Report(),
            "average rate: 5.000\n\tmin: 0.10000s max: 0.30000s std dev: 0.08165s window: 4");
}

TEST(Meters, AWindowForgetsWhatIsOld) {
  RateMeter meter(10);
  for (int k = 0; k < 5; ++k) meter.Add(AtSecond(k));
  for (int k = 1; k <= 10; ++k) meter.Add(AtSecond(4 + 0.1 * k));
  EXPECT_NEAR(meter.hz(), 10.0, 1e-6);
}

TEST(Meters, BandwidthIsBytesOverTheTimeTheyTook) {
  BandwidthMeter meter(100);
  EXPECT_FALSE(meter.Report());
  for (int k = 0; k <= 20; ++k) meter.Add(AtSecond(0.05 * k), 1000);
  EXPECT_NEAR(meter.bytes_per_second(), 20000.0, 1e-6);
  EXPECT_EQ(*meter.Report(),
            "20.00 KB/s from 20 messages\n\tMessage size mean: 1.00 KB min: 1.00 KB max: 1.00 KB");
}

TEST(ArrivalWatch, SaysOnceInASilenceThatNothingArrives) {
  using enum ArrivalWatch::Finding;
  ArrivalWatch watch;
  std::vector<ArrivalWatch::Finding> found;
  for (const std::uint64_t received : {0U, 0U, 0U, 0U, 5U, 5U, 5U, 6U, 6U, 6U, 6U, 6U})
    found.push_back(watch.Look(received));
  EXPECT_EQ(found, (std::vector{kNone, kNone, kSilent, kNone, kNew, kNone, kNone, kNew, kNone, kNone, kSilent,
                                kNone}));
}

TEST(Meters, DelaysMayBeNegativeWhereClocksDiffer) {
  DelayMeter meter(100);
  EXPECT_FALSE(meter.Report());
  meter.Add(FromSeconds(-0.010));
  meter.Add(FromSeconds(0.030));
  EXPECT_EQ(*meter.Report(),
            "average delay: 0.010\n\tmin: -0.01000s max: 0.03000s std dev: 0.02000s window: 2");
}

}  // namespace
}  // namespace thalweg::inspector
