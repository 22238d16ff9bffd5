#include "services/cli/report/remaining_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace thalweg::cli {
namespace {

/// A sample each second up to `until`, with the number of frontiers that the function gives.
std::vector<ProgressSample> Watched(double until, const std::function<double(double)>& frontiers) {
  std::vector<ProgressSample> samples;
  for (double time = 0.0; time <= until; time += 1.0) {
    ProgressSample sample;
    sample.time = time;
    sample.frontiers = static_cast<unsigned>(std::lround(frontiers(time)));
    samples.push_back(sample);
  }
  return samples;
}

TEST(RemainingTime, IsThatOfFrontiersWhoseSquareRootFallsEvenly) {
  // n(t) = 180 (1 - t / 240)^2 ends at 240 s.
  for (const double now : {60.0, 100.0, 150.0, 200.0}) {
    const auto left =
        RemainingTime(Watched(now, [](double t) { return 180.0 * (1.0 - t / 240.0) * (1.0 - t / 240.0); }));
    ASSERT_TRUE(left) << now;
    EXPECT_NEAR(*left, 240.0 - now, 0.05 * (240.0 - now)) << now;
  }
}

TEST(RemainingTime, LiesBetweenWhatALineAndAnExponentialSay) {
  // 100 frontiers at 0 s, 50 at 60 s: the line ends after another 60 s, the exponential falls below one after
  // another 60 s * log2(50).
  const auto left = RemainingTime(Watched(60.0, [](double t) { return 100.0 - 50.0 * t / 60.0; }));
  ASSERT_TRUE(left);
  EXPECT_GT(*left, 60.0);
  EXPECT_LT(*left, 60.0 * std::log2(50.0));
}

TEST(RemainingTime, IsUnknownWhileTheKnownVolumeGrows) {
  std::vector<ProgressSample> samples = Watched(100.0, [](double t) { return 100.0 - 0.5 * t; });
  for (ProgressSample& sample : samples) sample.explored = 100.0;
  EXPECT_TRUE(RemainingTime(samples));
  samples.back().explored = 119.0;
  EXPECT_TRUE(RemainingTime(samples));
  samples.back().explored = 121.0;
  EXPECT_FALSE(RemainingTime(samples));
}

TEST(RemainingTime, IsUnknownWhileNobodyCanKnow) {
  EXPECT_FALSE(RemainingTime({}));
  EXPECT_FALSE(RemainingTime(std::vector<ProgressSample>(100))) << "no explorer was heard";
  EXPECT_FALSE(RemainingTime(Watched(100.0, [](double t) { return 10.0 + t; }))) << "they become more";
  EXPECT_FALSE(RemainingTime(Watched(100.0, [](double) { return 50.0; }))) << "they stay";
  EXPECT_FALSE(RemainingTime(Watched(15.0, [](double t) { return 100.0 - 5.0 * t; }))) << "too early";
  EXPECT_FALSE(RemainingTime(Watched(60.0, [](double t) { return t < 50.0 ? 50.0 : 0.0; }))) << "none left";
}

TEST(AboutText, IsAsVagueAsTheEstimate) {
  EXPECT_EQ(AboutText(10.0), "under a minute");
  EXPECT_EQ(AboutText(50.0), "about 1 min");
  EXPECT_EQ(AboutText(130.0), "about 2 min");
  EXPECT_EQ(AboutText(3600.0), "about 60 min");
  EXPECT_EQ(AboutText(3.2 * 3600.0), "about 3 h");
}

}  // namespace
}  // namespace thalweg::cli
