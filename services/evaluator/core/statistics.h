#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace thalweg::evaluator {

double Mean(std::span<const double> values);               ///< NaN without values.
double StandardDeviation(std::span<const double> values);  ///< Of the sample (n - 1); NaN below two values.
/// Between the order statistics linearly [Hyndman, Fan: Sample quantiles in statistical packages, 1996, type
/// 7].
/// @param share  0 to 1. NaN without values.
double Quantile(std::span<const double> values, double share);

struct Interval {
  double low = 0.0;
  double high = 0.0;
};
/// Of the mean: percentile bootstrap, 2 000 resamples [Efron 1979]. The same input gives the same interval.
Interval BootstrapOfMean(std::span<const double> values, double confidence = 0.95);

/// Paired runs: a is compared with b start by start, in one world or in several.
struct PairedRatio {
  std::size_t worlds = 0;  ///< That have pairs.
  std::size_t pairs = 0;   ///< Of all worlds.
  double mean = 0.0;       ///< Geometric mean of a / b; of several worlds, each counts the same.
  Interval interval;       ///< 95 %, bootstrap over the pairs of each world; the worlds stay as they are.
  double p = 1.0;          ///< Two-sided sign-flip test of that mean being 1: 10 000 random flips.
};
/// @param log_ratios  log(a / b) of the pairs of each world. All NaN without values.
PairedRatio RatioOver(std::span<const std::vector<double>> log_ratios);
/// One world. @param a, b  The same number of positive values.
PairedRatio RatioOf(std::span<const double> a, std::span<const double> b);

}  // namespace thalweg::evaluator
