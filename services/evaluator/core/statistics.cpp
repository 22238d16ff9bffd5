#include "services/evaluator/core/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "common/base/check.h"

namespace thalweg::evaluator {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr int kResamples = 2000;
constexpr int kFlips = 10000;

}  // namespace

double Mean(std::span<const double> values) {
  if (values.empty()) return kNone;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double StandardDeviation(std::span<const double> values) {
  if (values.size() < 2) return kNone;
  const double mean = Mean(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

double Quantile(std::span<const double> values, double share) {
  if (values.empty()) return kNone;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], at - static_cast<double>(below));
}

Interval BootstrapOfMean(std::span<const double> values, double confidence) {
  if (values.empty()) return {kNone, kNone};
  std::mt19937_64 random(1);
  std::vector<double> means;
  for (int k = 0; k < kResamples; ++k) {
    double sum = 0.0;
    // Not std::uniform_int_distribution, which differs between standard libraries.
    for (std::size_t n = 0; n < values.size(); ++n) sum += values[random() % values.size()];
    means.push_back(sum / static_cast<double>(values.size()));
  }
  const double tail = 0.5 * (1.0 - confidence);
  return {Quantile(means, tail), Quantile(means, 1.0 - tail)};
}

PairedRatio RatioOver(std::span<const std::vector<double>> log_ratios) {
  PairedRatio ratio;
  std::vector<double> means;
  for (const std::vector<double>& logs : log_ratios) {
    if (logs.empty()) continue;
    ratio.pairs += logs.size();
    means.push_back(Mean(logs));
  }
  ratio.worlds = means.size();
  if (means.empty()) return {.mean = kNone, .interval = {kNone, kNone}, .p = kNone};
  const double mean = Mean(means);
  ratio.mean = std::exp(mean);

  const double count = static_cast<double>(ratio.worlds);
  /// Mean over worlds of the mean of `pick` over each world's pairs.
  const auto mean_of = [&](auto&& pick) {
    double sum = 0.0;
    for (const std::vector<double>& logs : log_ratios) {
      double of_world = 0.0;
      for (std::size_t n = 0; n < logs.size(); ++n) of_world += pick(logs, n);
      if (!logs.empty()) sum += of_world / static_cast<double>(logs.size());
    }
    return sum / count;
  };
  std::mt19937_64 random(1);
  std::vector<double> resampled;
  for (int k = 0; k < kResamples; ++k) {
    resampled.push_back(
        mean_of([&](const std::vector<double>& logs, std::size_t) { return logs[random() % logs.size()]; }));
  }
  ratio.interval = {std::exp(Quantile(resampled, 0.025)), std::exp(Quantile(resampled, 0.975))};

  random.seed(1);
  int as_far = 0;
  for (int k = 0; k < kFlips; ++k) {
    const double flipped = mean_of([&](const std::vector<double>& logs, std::size_t n) {
      return random() % 2 == 0 ? logs[n] : -logs[n];
    });
    as_far += std::abs(flipped) >= std::abs(mean) * (1.0 - 1e-12) ? 1 : 0;
  }
  ratio.p = (as_far + 1.0) / (kFlips + 1.0);
  return ratio;
}

PairedRatio RatioOf(std::span<const double> a, std::span<const double> b) {
  THALWEG_CHECK(a.size() == b.size());
  std::vector<double> logs;
  for (std::size_t n = 0; n < a.size(); ++n) logs.push_back(std::log(a[n] / b[n]));
  return RatioOver({&logs, 1});
}

}  // namespace thalweg::evaluator
