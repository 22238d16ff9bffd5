#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "services/evaluator/core/own_pose.h"
#include "services/evaluator/core/run_end.h"
#include "services/explorer/core/exploration_loop.h"
#include "services/mapper/core/occupancy_map.h"
#include "services/simulator/core/truth.h"
#include "services/simulator/core/world.h"

namespace thalweg::evaluator {

/// One exploration in lock step: simulator, mapper and explorer cores in one thread, without DDS, as fast as
/// they go. The same input gives the same run. The exploration loop is the one that the explorer service
/// runs: it gets poses, scans and the state of motion as that does, and gives the same orders.
///
/// Motion is kinematic: straight along the path at the robot's greatest speed, turning meanwhile. Without the
/// true pose it is carried out as the robot believes itself to be: it moves in its own axes, by what would
/// bring it to where it wants to be if it were where it believes. Between two frames its belief follows its
/// motion.
struct LockstepOptions {
  RobotModel robot;
  DepthSensorModel sensor;
  mapper::OccupancyMap::Options mapper;
  explorer::Explorer::Options explorer;
  std::optional<OwnPose::Options> own_pose;  ///< None: the robot knows its true pose.
  std::uint32_t noise_seed = 1;
  double time_step = 0.02;         ///< [s]
  double max_duration = 4 * 3600;  ///< [s] of simulated time; then the run is cut off
  std::stop_token stop;            ///< When requested, the run ends soon, as interrupted.
};

struct LockstepResult {
  RunEnd end;
  double distance = 0.0;  ///< [m]
  double duration = 0.0;  ///< [s] simulated
  std::size_t scans = 0;
  int collisions = 0;            ///< times the robot came to touch a surface
  double least_clearance = 1e9;  ///< [m] from the robot's body to a surface
  std::size_t replans = 0;       ///< Paths given up because they were unsafe to go on.
  std::size_t reversals = 0;     ///< Paths that set out against the direction of the last half metre.
  explorer::Explorer::Status explorer;
  std::optional<OwnPose::Figures> own_pose;
  struct Sample {
    double time = 0.0;         ///< [s]
    double distance = 0.0;     ///< [m]
    Eigen::Vector3d p_W;       ///< The true place.
    std::size_t known = 0;     ///< voxels
    std::size_t observed = 0;  ///< Of these, in the true map's observable set; 0 without one.
  };
  std::vector<Sample> samples;  ///< One a scan.
};

/// Sees each plan as it is made; for logs and pictures.
using PlanObserver =
    std::function<void(const explorer::Plan&, const explorer::Explorer&, const RigidTransform&)>;

LockstepResult RunLockstep(const simulator::World& world, const RigidTransform& T_WB_start,
                           const LockstepOptions& options, mapper::OccupancyMap& map,
                           const PlanObserver& observe = {}, const simulator::TrueMap* truth = nullptr);

}  // namespace thalweg::evaluator
