#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/timed_pose.h"

namespace thalweg::cli {

/// The state of a run at one point in time.
struct ProgressSample {
  double time = 0.0;               ///< [s] On the run's clock, since its start.
  double distance = 0.0;           ///< [m] Distance traveled.
  double explored = 0.0;           ///< [m^3] Known volume.
  std::optional<double> coverage;  ///< Known share of what can be observed at all; needs the true world.
};

/// Durations of one repeated operation.
struct StageTiming {
  std::string name;
  std::uint64_t count = 0;
  double p50_ms = 0.0;
  double p95_ms = 0.0;
  double max_ms = 0.0;
};

/// Frontiers set aside for one reason.
struct FrontiersSetAside {
  std::string reason;
  std::uint32_t clusters = 0;
  std::uint32_t voxels = 0;
};

/// Messages of one kind that a service did not use.
struct MessageCount {
  std::string service;
  std::string name;  ///< Topic and event.
  std::uint64_t count = 0;
  std::string last;  ///< Latest reason.
};

/// Everything that is reported about a run, without what can be derived from it.
struct RunRecord {
  std::string title;        ///< For people; may be empty.
  std::string scenario;     ///< As given on the command line.
  std::string strategy;     ///< Empty if no explorer was heard.
  std::string stop_reason;  ///< complete, ..., interrupted, or what failed.
  /// The explorer's last activity, one line; empty unless the exploration was done.
  std::string end;
  bool succeeded = false;  ///< Whether it ended as intended: everything seen, or home within a budget.

  double distance = 0.0;  ///< [m] By odometry.
  double duration = 0.0;  ///< [s] On the run's clock.
  double wall = 0.0;      ///< [s]

  double free_volume = 0.0;      ///< [m^3]
  double occupied_volume = 0.0;  ///< [m^3]

  // Known only if there is a simulator and a true world.
  std::optional<std::uint32_t> true_collisions;
  std::optional<double> least_clearance;  ///< [m]
  /// Share of the observable voxels that the map classifies correctly.
  std::optional<double> agreement;
  std::optional<double> coverage;  ///< Share of the observable voxels that the map knows.

  std::vector<ProgressSample> progress;
  std::vector<FrontiersSetAside> set_aside;
  std::uint32_t frontiers_left = 0;
  std::uint64_t plans = 0;
  std::uint64_t replans = 0;
  std::vector<StageTiming> planning;
  std::vector<StageTiming> integration;
  std::vector<MessageCount> rejected;
  std::vector<MessageCount> dropped;
  std::vector<std::string> warnings;  ///< What to know about the run's files and figures, one line each.
  std::vector<TimedPose> trajectory;  ///< T_WB
};

}  // namespace thalweg::cli
