#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "services/controller/core/controller_type.h"
#include "services/evaluator/core/contact_meter.h"
#include "services/evaluator/core/motion_meter.h"
#include "services/evaluator/core/own_pose.h"
#include "services/evaluator/core/run_end.h"
#include "services/evaluator/core/stereo_sensor.h"
#include "services/explorer/core/exploration_loop.h"
#include "services/mapper/core/occupancy_map.h"
#include "services/simulator/core/truth.h"
#include "services/simulator/core/world.h"

namespace thalweg::evaluator {

/// How the robot of a run in lock step moves, see LockstepOptions.
enum class MotionModel : std::uint8_t { kKinematic, kDynamic };

/// Options of one exploration in lock step: the cores of simulator, mapper and explorer run in one thread,
/// without DDS, as fast as possible. The same input gives the same run. The exploration loop is the one that
/// the explorer service runs: it receives poses, scans and the motion status in the same way and gives the
/// same orders.
///
/// Kinematic motion is straight along the path at the robot's maximum speed, rotating meanwhile. Without the
/// true pose, it is executed in the robot's estimated frame: the robot moves in its own axes by what would
/// take it to the goal if its estimate were right. Between two frames the estimate follows the executed
/// motion.
///
/// Dynamic motion is the controller's: it leads the robot, which follows exactly, so that speed,
/// acceleration, turn rate and turn acceleration stay within the robot's limits. It brakes no harder in an
/// emergency. The robot knows its true pose.
struct LockstepOptions {
  RobotModel robot;
  DepthSensorModel sensor;                      ///< What the explorer expects to see.
  std::optional<StereoSensor::Options> stereo;  ///< Where clouds come from; empty: from the sensor.
  mapper::OccupancyMap::Options mapper;
  FilterModel filter;  ///< What is dropped of each cloud before it is fused.
  explorer::Explorer::Options explorer;
  std::optional<OwnPose::Options> own_pose;  ///< Empty: the robot knows its true pose.
  MotionModel motion = MotionModel::kKinematic;
  controller::ControllerType controller = controller::ControllerType::kPathFollower;  ///< For dynamic motion.
  std::uint32_t noise_seed = 1;
  bool colors = false;             ///< Whether clouds have colors, which cost as much as casting their rays.
  double time_step = 0.02;         ///< [s]
  double max_duration = 4 * 3600;  ///< [s] Simulated time after which the run is cut off.
  std::stop_token stop;            ///< When requested, the run ends soon, as interrupted.
};

struct LockstepResult {
  RunEnd end;
  double distance = 0.0;  ///< [m]
  double duration = 0.0;  ///< [s] Simulated.
  std::size_t scans = 0;
  int collisions = 0;                            ///< Number of times the robot began to touch a surface.
  double least_clearance = ContactMeter::kNone;  ///< [m] From the robot's body to a surface.
  std::size_t replans = 0;                       ///< Paths abandoned because they were no longer safe.
  std::size_t reversals = 0;  ///< Paths that start against the heading of the last half meter.
  MotionFigures motion;       ///< What the true body did.
  explorer::Explorer::Status explorer;
  std::optional<OwnPose::Figures> own_pose;
  struct Sample {
    double time = 0.0;         ///< [s]
    double distance = 0.0;     ///< [m]
    Eigen::Vector3d p_W;       ///< The true position.
    std::size_t known = 0;     ///< Number of voxels.
    std::size_t observed = 0;  ///< Those of them in the true map's observable set; 0 without a true map.
  };
  std::vector<Sample> samples;  ///< One per scan.
};

/// Called with each plan as it is made, for logs and pictures.
using PlanObserver =
    std::function<void(const explorer::Plan&, const explorer::Explorer&, const RigidTransform&)>;

/// Called after each scan, once it is in the explorer's map.
using ScanObserver = std::function<void(const LockstepResult::Sample&, const explorer::Explorer&)>;

/// Called with each cloud, and where the camera was thought to be and was when it was taken.
using CloudObserver =
    std::function<void(const PointCloud&, const RigidTransform& T_WC, const RigidTransform& T_WC_true)>;

/// Where parts of the world move, the run moves those of a copy: its time is theirs.
/// Throws std::invalid_argument if motion is to be dynamic without the true pose.
LockstepResult RunLockstep(const simulator::World& world, const RigidTransform& T_WB_start,
                           const LockstepOptions& options, mapper::FusedMap& map,
                           const PlanObserver& observe = {}, const simulator::TrueMap* truth = nullptr,
                           const ScanObserver& observe_scan = {}, const CloudObserver& observe_cloud = {});

}  // namespace thalweg::evaluator
