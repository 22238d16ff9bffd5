#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/evaluator/core/lockstep.h"
#include "services/evaluator/core/offline_tour.h"
#include "services/evaluator/core/surface_recorder.h"
#include "services/evaluator/core/tail.h"

namespace thalweg::evaluator {

/// The coverages for which path lengths are reported.
inline constexpr int kCoveragePercents[] = {50, 90, 95, 99};
/// Known voxels whose log odds are nearer to 0 than these are counted as doubtful: their state may well be
/// the opposite.
inline constexpr std::array kDoubtfulLogOdds = {0.3, 0.6};

/// The record of one run. Everything except `timings`, `wall` and `cpu` is the same on every machine and
/// repetition.
struct Outcome {
  std::string scenario;
  std::string strategy;
  int run = 0;   ///< 0, 1, ...; runs with the same number start at the same pose, whatever the strategy.
  int seed = 0;  ///< For start and noise.

  RunEnd end;
  double distance = 0.0;   ///< [m]
  double duration = 0.0;   ///< [s] simulated
  double coverage = 0.0;   ///< Known share of the voxels that this robot can observe.
  double agreement = 0.0;  ///< Share of these voxels that the map has right.
  /// Share of these voxels that are known, but with log odds nearer to 0 than each of kDoubtfulLogOdds.
  std::array<double, kDoubtfulLogOdds.size()> doubtful{};
  /// Share of the voxels of the world's box that a sensor without noise would have left in the same state,
  /// see NoiseFreeMap. Empty: the sensor has no noise, it is a stereo camera, the pose is not known, or parts
  /// of the world move.
  std::optional<double> likeness;
  MotionFigures motion;
  int collisions = 0;            ///< True contacts.
  double least_clearance = 0.0;  ///< [m]
  std::size_t scans = 0;
  std::size_t plans = 0;
  std::size_t replans = 0;
  std::size_t reversals = 0;
  std::size_t left_out = 0;  ///< Places where the strategy would have looked, had the map allowed it.
  std::vector<explorer::SetAsideCount> set_aside;
  std::optional<OwnPose::Figures> own_pose;  ///< Empty: the robot knew its true pose.
  std::optional<Tail> tail;                  ///< Empty: it was not recorded.
  std::optional<SurfaceFigures> surface;     ///< Empty: surfaces were not looked at.
  std::string mesh_hash;                     ///< HashText of the mesh that was written; empty: none was.
  std::optional<OfflineTours> optimum;       ///< From the start of the run; empty: not computed.

  /// Progress of the run, thinned out: a point for each quarter meter, each half percent of coverage, and
  /// each of kCoveragePercents and kTourCoverages reached.
  struct Progress {
    double time = 0.0;      ///< [s]
    double distance = 0.0;  ///< [m]
    double coverage = 0.0;
    Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  };
  std::vector<Progress> progress;

  std::map<std::string, TimingStatistics::Summary> timings;  ///< By stage of planning.
  double wall = 0.0;                                         ///< [s]
  double cpu = 0.0;  ///< [s] CPU time of the thread, which does not depend on other load.

  bool complete() const { return end.complete(); }
};

/// Computes the measured part of an outcome; the caller fills in scenario, strategy, run and seed.
Outcome Judge(const LockstepResult& result, const OccupancyGrid& map, const simulator::TrueMap& truth);

/// [m] Length traveled when that coverage was reached; empty when it never was.
std::optional<double> PathTo(const Outcome& outcome, double coverage);

/// [s] Simulated time when that coverage was reached; empty when it never was.
std::optional<double> TimeTo(const Outcome& outcome, double coverage);

/// Coverage reached by a time [s] or a length traveled [m]; 0 before the first point of the progress.
/// @param along  Which of the two, &Outcome::Progress::time or distance.
double CoverageAt(const Outcome& outcome, double Outcome::Progress::*along, double at);

/// Mean coverage over the first `horizon` meters. After the end of the run, coverage stays at its last value.
double AreaUnderCoverage(const Outcome& outcome, double horizon);

}  // namespace thalweg::evaluator
