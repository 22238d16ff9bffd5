#include "common/base/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace thalweg {
namespace {

TEST(TimingStatistics, AreZeroWithoutSamples) {
  const TimingStatistics::Summary summary = TimingStatistics().Summarize();
  EXPECT_EQ(summary.count, 0U);
  EXPECT_EQ(summary.p50_ms, 0.0);
  EXPECT_EQ(summary.p95_ms, 0.0);
  EXPECT_EQ(summary.max_ms, 0.0);
}

/// The error that binning may introduce.
double Tolerance(double value) {
  return 0.01 * value;
}

TEST(TimingStatistics, OfOneToHundredAreTheRanksThemselves) {
  TimingStatistics statistics;
  for (int k = 100; k >= 1; --k) statistics.Add(k);
  const TimingStatistics::Summary summary = statistics.Summarize();
  EXPECT_EQ(summary.count, 100U);
  EXPECT_NEAR(summary.p50_ms, 50.0, Tolerance(50.0));
  EXPECT_NEAR(summary.p95_ms, 95.0, Tolerance(95.0));
  EXPECT_EQ(summary.max_ms, 100.0);
}

TEST(TimingStatistics, PercentileIsTheSmallestSampleThatThatManyDoNotExceed) {
  std::mt19937 random(1);
  for (int count = 1; count < 60; ++count) {
    TimingStatistics statistics;
    std::vector<double> samples;
    for (int k = 0; k < count; ++k) {
      samples.push_back(std::uniform_int_distribution(0, 30)(random));
      statistics.Add(samples.back());
    }
    const auto percentile = [&](int percent) {
      double smallest = std::numeric_limits<double>::infinity();
      for (const double sample : samples) {
        const auto below =
            std::count_if(samples.begin(), samples.end(), [&](double other) { return other <= sample; });
        if (100 * below >= percent * count) smallest = std::min(smallest, sample);
      }
      return smallest;
    };
    EXPECT_NEAR(statistics.Summarize().p50_ms, percentile(50), Tolerance(percentile(50))) << count;
    EXPECT_NEAR(statistics.Summarize().p95_ms, percentile(95), Tolerance(percentile(95))) << count;
  }
}

TEST(TimingStatistics, AreWithinOnePercentFromMicrosecondsToHours) {
  for (double value = 1e-3; value < 1e7; value *= 1.37) {
    TimingStatistics statistics;
    for (int k = 0; k < 99; ++k) statistics.Add(value);
    statistics.Add(2.0 * value);
    EXPECT_NEAR(statistics.Summarize().p50_ms, value, Tolerance(value));
    EXPECT_EQ(statistics.Summarize().max_ms, 2.0 * value);
  }
}

}  // namespace
}  // namespace thalweg
