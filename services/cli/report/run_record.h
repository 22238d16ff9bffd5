#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/robot_model.h"
#include "common/geometry/timed_pose.h"
#include "services/explorer/core/outcome.h"

namespace thalweg::cli {

/// The state of a run at one point in time.
struct ProgressSample {
  double time = 0.0;                  ///< [s] On the run's clock, since its start.
  double distance = 0.0;              ///< [m] Distance traveled.
  double explored = 0.0;              ///< [m^3] Known volume.
  std::optional<unsigned> frontiers;  ///< Clusters left to see.
  std::optional<double> planning_ms;  ///< Median time of a plan so far.
  std::optional<double> coverage;     ///< Known share of what can be observed at all; needs the true world.
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

/// A plan of the explorer, and what became of it.
struct Decision {
  std::uint64_t number = 0;                 ///< From 1, over all explorers of the run.
  double time = 0.0;                        ///< [s] On the run's clock.
  std::string purpose;                      ///< What it does and why, in the explorer's words.
  std::optional<Eigen::Vector3d> target_W;  ///< What it goes to see.
  std::optional<double> length;             ///< [m] Length of its path.
  std::string interruption;                 ///< Why it was abandoned; empty if it was carried out.
};

/// A frontier as the explorer last reported it.
struct FrontierMark {
  Eigen::Vector3d center_W = Eigen::Vector3d::Zero();
  std::uint32_t voxels = 0;
  int fate = 0;        ///< As thalweg_msgs FrontierFate: 0 left, 1 chosen, 2 set aside.
  std::string reason;  ///< Why it was set aside.
};

/// All processes of one service.
struct ServiceRecord {
  std::string name;
  std::string host;                  ///< Where its latest process runs.
  std::size_t processes = 0;         ///< Processes that were heard; more than one if it was restarted.
  double uptime = 0.0;               ///< [s] How long its latest process has run.
  std::uint64_t rejected = 0;        ///< Messages, of all its processes.
  std::uint64_t dropped = 0;         ///< Likewise.
  std::vector<StageTiming> timings;  ///< As measured by its latest process.
};

/// Everything that is reported about a run, without what can be derived from it.
struct RunRecord {
  std::string title;        ///< For people; may be empty.
  std::string scenario;     ///< As given on the command line.
  std::string strategy;     ///< Empty if no explorer was heard.
  std::string stop_reason;  ///< complete, ..., interrupted, or what failed.
  /// Why the explorer ended the exploration; empty if it did not, or for a reason of an outside explorer.
  std::optional<explorer::Outcome> outcome;
  std::string stop_details;  ///< What stayed unknown and what to check, one line; may be empty.
  bool succeeded = false;    ///< Whether it ended as intended: everything seen, or home within a budget.

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
  /// Clouds or depth images that the mapper did not use: lost on the way, too late, without a pose.
  std::uint64_t clouds_not_mapped = 0;
  std::string clouds_not_mapped_why;  ///< The last reason.
  /// What the service `surface` has, where it runs.
  struct Surface {
    double seen = 0.0;                 ///< [m^2] Area of the mesh, which noise makes larger than what it shows.
    double inspected = 0.0;            ///< [m^2] What of it a view saw near and square enough.
    std::optional<double> observable;  ///< [m^2] What there is to see; absent without a true world.
    std::uint64_t clouds_not_fused = 0;
    std::string clouds_not_fused_why;  ///< The last reason.
  };
  std::optional<Surface> surface;
  std::vector<std::string> warnings;  ///< What to know about the run's files and figures, one line each.
  std::vector<TimedPose> trajectory;  ///< T_WB
  std::vector<Decision> decisions;
  std::size_t decisions_forgotten = 0;  ///< Earlier ones that are not listed.
  std::vector<FrontierMark> frontiers;  ///< As of the last plan.
  std::vector<ServiceRecord> services;
  RobotModel robot;
  PinholeCamera camera = DepthSensorModel{}.camera;  ///< The robot's.
  std::string scenario_text;                         ///< All of it, with defaults marked.
};

}  // namespace thalweg::cli
