#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/evaluator/core/lockstep.h"

namespace thalweg::evaluator {

/// To which the paths are told.
inline constexpr int kCoveragePercents[] = {50, 90, 95, 99};
/// Known voxels of log odds nearer to 0 than these are counted: they may as well be the opposite.
inline constexpr std::array kDoubtfulLogOdds = {0.3, 0.6};

/// What is kept of one run. All but `timings`, `wall` and `cpu` is the same whenever and wherever it is
/// repeated.
struct Outcome {
  std::string scenario;
  std::string strategy;
  int run = 0;   ///< 0, 1, ...: runs of the same number have the same start, whatever the strategy.
  int seed = 0;  ///< Of start and noise.

  RunEnd end;
  double distance = 0.0;   ///< [m]
  double duration = 0.0;   ///< [s] simulated
  double coverage = 0.0;   ///< Known share of all that this robot could see, from anywhere it can reach.
  double agreement = 0.0;  ///< Share of the same that the map has right.
  /// Share of the same that is known, but with log odds nearer to 0 than those of kDoubtfulLogOdds.
  std::array<double, kDoubtfulLogOdds.size()> doubtful{};
  int collisions = 0;            ///< True ones.
  double least_clearance = 0.0;  ///< [m]
  std::size_t scans = 0;
  std::size_t plans = 0;
  std::size_t replans = 0;
  std::size_t reversals = 0;
  std::vector<explorer::SetAsideCount> set_aside;
  std::optional<OwnPose::Figures> own_pose;  ///< None: it knew its true pose.

  /// Where the run stood, thinned out: a point when a quarter metre or half a percent has been added, or one
  /// of kCoveragePercents was passed.
  struct Progress {
    double time = 0.0;      ///< [s]
    double distance = 0.0;  ///< [m]
    double coverage = 0.0;
    Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  };
  std::vector<Progress> progress;

  std::map<std::string, TimingStatistics::Summary> timings;  ///< By stage of planning.
  double wall = 0.0;                                         ///< [s]
  double cpu = 0.0;                                          ///< [s] Of its thread, on a busy machine, too.

  bool complete() const { return end.complete(); }
};

/// The judged part of an outcome; who it was of is left to the caller.
Outcome Judge(const LockstepResult& result, const OccupancyGrid& map, const simulator::TrueMap& truth);

/// [m] travelled when that coverage was reached; nothing when it never was.
std::optional<double> PathTo(const Outcome& outcome, double coverage);

/// Mean coverage over the first `horizon` metres; after the end it stays what it was.
double AreaUnderCoverage(const Outcome& outcome, double horizon);

}  // namespace thalweg::evaluator
