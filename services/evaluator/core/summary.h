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
  Interval interval;  ///< 95 % confidence interval of the mean.
};
Figures FiguresOf(std::span<const double> values);

/// The scenarios or strategies of the runs, each once, in their order: NamesIn(outcomes, &Outcome::strategy).
std::vector<std::string> NamesIn(std::span<const Outcome> outcomes, std::string Outcome::*name);

/// Statistics over all runs of one strategy in one scenario.
struct Summary {
  std::string scenario;
  std::string strategy;
  std::size_t runs = 0;
  std::size_t completed = 0;
  Figures path;  ///< [m] Path length to the end.
  /// [m] Path length to 50, 90, 95 and 99 % coverage, over the runs that reached it.
  std::map<int, Figures> path_to;
  Figures area;  ///< Mean coverage over the first `horizon` meters, i.e. the normalized area under its curve.
  double horizon = 0.0;  ///< [m] Per scenario: the median path length of the first strategy there.
  Figures coverage, agreement;
  Figures likeness;                         ///< In the runs that have one.
  std::map<std::string, Figures> doubtful;  ///< Keyed by the bound on the absolute log odds.
  Figures duration;                         ///< [s]
  std::map<int, Figures> time_to;           ///< [s] As path_to.
  Figures moving, turning, standing;        ///< [s] See MotionFigures.
  Figures stops;
  Figures speed;         ///< [m/s] Path / duration.
  MotionFigures motion;  ///< The greatest values of all runs; the others are 0.
  Figures scans, replans, reversals;
  Figures cpu;                   ///< [s]
  int collisions = 0;            ///< Sum over all runs.
  double least_clearance = 0.0;  ///< [m] Smallest over all runs.
  struct StageTime {
    double p50_ms = 0.0;  ///< Median over the runs of each run's percentile.
    double p95_ms = 0.0;  ///< Likewise.
    double max_ms = 0.0;  ///< Largest over all runs.
  };
  /// By name; kPlanStage is a whole decision, of which the others are parts.
  std::map<std::string, StageTime> stages;
  StageTime plan() const;  ///< The one of kPlanStage; NaN when none was timed.
  /// How many runs ended alike, by what NameOf says and whether the robot was home within its budget.
  struct EndCount {
    RunEnd end;  ///< The first such run's.
    int runs = 0;
  };
  std::vector<EndCount> ends;  ///< In the order in which they first occurred.
  struct SetAside {
    double clusters = 0.0;  ///< Mean over all runs at their ends.
    double voxels = 0.0;    ///< Likewise.
  };
  std::map<std::string, SetAside> set_aside;  ///< Frontiers by reason.

  /// Path length relative to the offline tour from the same start, which is an upper bound of the optimum.
  struct OfOptimum {
    std::size_t runs = 0;  ///< Those that reached the coverage and have a tour to it.
    double ratio = 0.0;    ///< Path / tour, geometric mean of the runs; NaN without any.
    double tour = 0.0;     ///< [m] Mean of their tours; NaN without any.
  };
  std::map<std::string, OfOptimum> of_optimum;  ///< By percent of coverage; empty: no tours were computed.

  /// Where the paths of the runs that reached kTailCoverage go after it; shares are of all their tails
  /// together. NaN where there is nothing to count.
  struct TailFigures {
    std::size_t runs = 0;
    double begins = 0.0;                         ///< [m] Mean.
    double length = 0.0;                         ///< [m] Mean.
    double journeys = 0.0;                       ///< Mean number.
    double median = 0.0;                         ///< [m] Over all journeys.
    double long_share = 0.0;                     ///< Share of the journeys that are at least kLongJourney.
    double long_length_share = 0.0;              ///< Share of the length that is in those.
    double target = 0.0;                         ///< [voxels] Median.
    double small_length_share = 0.0;             ///< Share to targets of at most kSmallTarget.
    std::map<Tail::Kind, double> length_shares;  ///< By kind of journey.
    double in_sight_length_share = 0.0;          ///< Share to targets passed by that had been in sight.
  };
  std::optional<TailFigures> tail;  ///< Empty: no tails were recorded.

  std::optional<SurfaceFigures> surface;  ///< Means over the runs; empty: no surfaces were looked at.
};

/// "95", "99.8"
std::string PercentText(double coverage);
/// How many times as long as the offline tour the path to kTourCoverages[k] was; empty unless both exist and
/// the tour leaves its start.
std::optional<double> OfOptimumAt(const Outcome& outcome, std::size_t k);

/// In order of first appearance of scenario and strategy.
std::vector<Summary> Summarize(std::span<const Outcome> outcomes);

/// With fewer pairs no sign test can decide: 2 of 2^5 flips are more than 5 %.
inline constexpr std::size_t kLeastPairs = 6;

/// Path length of one strategy relative to another in the same scenario, paired by start. Only starts for
/// which both have a value count.
struct Comparison {
  std::string scenario;  ///< Empty: all scenarios together.
  std::string strategy;
  std::string against;
  PairedRatio to_95;   ///< [m] to 95 % coverage, for pairs in which both reached it.
  PairedRatio to_end;  ///< [m] to the end, for pairs in which both completed.
  /// In how many of the compared worlds the whole interval lies below 1, and in how many above 1. Worlds with
  /// fewer than six pairs never count as decided.
  struct Decided {
    std::size_t shorter = 0;
    std::size_t longer = 0;
  };
  Decided decided_to_95;
  Decided decided_to_end;
};
/// Compares each strategy with `reference`, in each scenario and over all of them.
std::vector<Comparison> Compare(std::span<const Outcome> outcomes, const std::string& reference);

}  // namespace thalweg::evaluator
