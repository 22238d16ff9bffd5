#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace thalweg::evaluator {

double Mean(std::span<const double> values);  ///< NaN without values.
/// The sample's, with n - 1; NaN for fewer than two values.
double StandardDeviation(std::span<const double> values);
/// Interpolates linearly between the order statistics [Hyndman, Fan: Sample quantiles in statistical
/// packages, 1996, type 7].
/// @param share  0 to 1. NaN without values.
double Quantile(std::span<const double> values, double share);

struct Interval {
  double low = 0.0;
  double high = 0.0;
};
/// Confidence interval of the mean by percentile bootstrap with 2000 resamples [Efron 1979]. Deterministic.
Interval BootstrapOfMean(std::span<const double> values, double confidence = 0.95);

/// Paired comparison: a is compared with b start by start, in one world or several.
struct PairedRatio {
  std::size_t worlds = 0;  ///< Number of worlds that have pairs.
  std::size_t pairs = 0;   ///< In all worlds together.
  double mean = 0.0;       ///< Geometric mean of a / b; every world has the same weight.
  Interval interval;       ///< 95 %; bootstrap over the pairs of each world, with the worlds fixed.
  double p = 1.0;          ///< Two-sided sign-flip test that the mean is 1, with 10 000 random flips.
};
/// @param log_ratios  log(a / b) of the pairs of each world. Without values, all results are NaN.
PairedRatio RatioOver(std::span<const std::vector<double>> log_ratios);
/// The same for one world. @param a, b  Equal numbers of positive values.
PairedRatio RatioOf(std::span<const double> a, std::span<const double> b);

}  // namespace thalweg::evaluator
