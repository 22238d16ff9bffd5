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
  Figures area;          ///< Mean coverage over the first `horizon` metres: the area under its curve.
  double horizon = 0.0;  ///< [m] Of the scenario: the median path to the end of the first strategy there.
  Figures coverage, agreement;
  std::map<std::string, Figures> doubtful;  ///< By the log odds that they are nearer to 0 than.
  Figures duration;                         ///< [s]
  Figures scans, replans, reversals;
  Figures cpu;                   ///< [s]
  int collisions = 0;            ///< Of all runs together.
  double least_clearance = 0.0;  ///< [m] of all runs
  struct StageTime {
    double p50_ms = 0.0;  ///< Median over the runs of each run's percentile.
    double p95_ms = 0.0;  ///< The same.
    double max_ms = 0.0;  ///< Of all runs.
  };
  std::map<std::string, StageTime> stages;  ///< "plan" is a whole decision, the others are parts of it.
  StageTime plan() const;                   ///< NaN where none was timed.
  std::map<std::string, int> stop_reasons;
  struct SetAside {
    double clusters = 0.0;  ///< Mean of all runs, at their ends.
    double voxels = 0.0;    ///< The same.
  };
  std::map<std::string, SetAside> set_aside;  ///< Frontiers, by reason.
};

/// In the order in which scenario and strategy first come.
std::vector<Summary> Summarize(std::span<const Outcome> outcomes);

/// Path of one strategy over that of another, same scenario, same starts. Only starts where both have a
/// value.
struct Comparison {
  std::string scenario;  ///< Empty: all together.
  std::string strategy;
  std::string against;
  PairedRatio to_95;   ///< [m] until 95 % coverage; where both got there.
  PairedRatio to_end;  ///< [m] where both completed.
  /// Of the worlds compared: in how many the interval lies wholly below 1, and in how many wholly above.
  /// Worlds of fewer than six pairs are never decided.
  struct Decided {
    std::size_t shorter = 0;
    std::size_t longer = 0;
  };
  Decided decided_to_95;
  Decided decided_to_end;
};
/// Each strategy against `reference`, in each scenario and over all of them.
std::vector<Comparison> Compare(std::span<const Outcome> outcomes, const std::string& reference);

}  // namespace thalweg::evaluator
