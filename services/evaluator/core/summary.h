#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "services/evaluator/core/outcome.h"
#include "services/evaluator/core/statistics.h"

namespace thalweg::evaluator {

struct Figures {
  std::size_t count = 0;
  double mean = 0.0, deviation = 0.0, median = 0.0, least = 0.0, greatest = 0.0;  ///< NaN without values.
  Interval interval;                                                              ///< Of the mean, 95 %.
};
Figures FiguresOf(std::span<const double> values);

/// All runs of one strategy in one scenario.
struct Summary {
  std::string scenario;
  std::string strategy;
  std::size_t runs = 0;
  std::size_t completed = 0;
  Figures path;                    ///< [m] to the end
  std::map<int, Figures> path_to;  ///< [m] to 50, 90, 95 and 99 % coverage, of the runs that got there.
  Figures coverage, agreement;
  Figures duration;  ///< [s]
  Figures scans, replans, reversals;
  int collisions = 0;            ///< Of all runs together.
  double least_clearance = 0.0;  ///< [m] of all runs
  double plan_ms_p50 = 0.0;      ///< Median over the runs of each run's percentile.
  double plan_ms_p95 = 0.0;      ///< The same.
  double plan_ms_max = 0.0;
  std::map<std::string, int> stop_reasons;
};

inline constexpr int kCoveragePercents[] = {50, 90, 95, 99};

/// In the order in which scenario and strategy first come.
std::vector<Summary> Summarize(std::span<const Outcome> outcomes);

/// Path of one strategy over that of another, same scenario, same starts. Only starts where both have a
/// value.
struct Comparison {
  std::string scenario;  ///< Empty: all together.
  std::string strategy;
  std::string against;
  PairedRatio to_95;
  PairedRatio to_end;
};
/// Each strategy against `reference`, in each scenario and over all of them.
std::vector<Comparison> Compare(std::span<const Outcome> outcomes, const std::string& reference);

}  // namespace thalweg::evaluator
