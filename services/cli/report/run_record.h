#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/timed_pose.h"

namespace thalweg::cli {

/// Where a run stood at one moment.
struct ProgressSample {
  double time = 0.0;               ///< [s] of the run's clock, from its start.
  double distance = 0.0;           ///< [m] traveled.
  double explored = 0.0;           ///< [m^3] known.
  std::optional<double> coverage;  ///< Known share of what can be seen at all; needs the true world.
};

/// How long one repeated piece of work took.
struct StageTiming {
  std::string name;
  std::uint64_t count = 0;
  double p50_ms = 0.0;
  double p95_ms = 0.0;
  double max_ms = 0.0;
};

/// Frontiers given up for one reason.
struct FrontiersSetAside {
  std::string reason;
  std::uint32_t clusters = 0;
  std::uint32_t voxels = 0;
};

/// Messages of one kind that a service did not use.
struct MessageCount {
  std::string service;
  std::string name;  ///< Topic and what happened.
  std::uint64_t count = 0;
  std::string last;  ///< The latest reason.
};

/// Everything that is told about a run, and nothing that can be computed from it.
struct RunRecord {
  std::string title;        ///< For people; may be empty.
  std::string scenario;     ///< As given on the command line.
  std::string strategy;     ///< Empty: no explorer was heard.
  std::string stop_reason;  ///< complete, ..., interrupted, or what failed.
  std::string end;          ///< The explorer's last words, one line; empty unless it said that it is done.
  bool succeeded = false;   ///< It ended as it was meant to: everything seen, or home within a budget.

  double distance = 0.0;  ///< [m] by odometry.
  double duration = 0.0;  ///< [s] of the run's clock.
  double wall = 0.0;      ///< [s]

  double free_volume = 0.0;      ///< [m^3]
  double occupied_volume = 0.0;  ///< [m^3]

  // Known only where there is a simulator, and a true world.
  std::optional<std::uint32_t> true_collisions;
  std::optional<double> least_clearance;  ///< [m]
  std::optional<double> agreement;        ///< Share of the observable voxels that the map has right.
  std::optional<double> coverage;         ///< Share of the observable voxels that the map knows.

  std::vector<ProgressSample> progress;
  std::vector<FrontiersSetAside> set_aside;
  std::uint32_t frontiers_left = 0;
  std::uint64_t plans = 0;
  std::uint64_t replans = 0;
  std::vector<StageTiming> planning;
  std::vector<StageTiming> integration;
  std::vector<MessageCount> rejected;
  std::vector<MessageCount> dropped;
  std::vector<TimedPose> trajectory;  ///< T_WB
};

}  // namespace thalweg::cli
