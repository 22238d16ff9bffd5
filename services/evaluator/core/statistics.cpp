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
    // Not uniform_int_distribution, which is not the same in every library.
    for (std::size_t n = 0; n < values.size(); ++n) sum += values[random() % values.size()];
    means.push_back(sum / static_cast<double>(values.size()));
  }
  const double tail = 0.5 * (1.0 - confidence);
  return {Quantile(means, tail), Quantile(means, 1.0 - tail)};
}

PairedRatio RatioOf(std::span<const double> a, std::span<const double> b) {
  THALWEG_CHECK(a.size() == b.size());
  PairedRatio ratio;
  ratio.pairs = a.size();
  std::vector<double> logs;
  for (std::size_t n = 0; n < a.size(); ++n) logs.push_back(std::log(a[n] / b[n]));
  const double mean = Mean(logs);
  const Interval interval = BootstrapOfMean(logs);
  ratio.mean = std::exp(mean);
  ratio.interval = {std::exp(interval.low), std::exp(interval.high)};
  std::mt19937_64 random(1);
  int as_far = 0;
  for (int k = 0; k < kFlips; ++k) {
    double sum = 0.0;
    for (const double value : logs) sum += random() % 2 == 0 ? value : -value;
    as_far += std::abs(sum) >= std::abs(mean) * static_cast<double>(logs.size()) * (1.0 - 1e-12) ? 1 : 0;
  }
  ratio.p = (as_far + 1.0) / (kFlips + 1.0);
  return ratio;
}

}  // namespace thalweg::evaluator
