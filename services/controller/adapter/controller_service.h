#pragma once

#include <memory>
#include <optional>

#include "common/dds/bus.h"
#include "common/dds/map_replica.h"
#include "services/controller/adapter/options.h"
#include "services/controller/core/motion_controller.h"

namespace thalweg::controller {

/// Runs a motion controller on the bus: reads the path, the map if paths are checked, the exploration's
/// state, odometry and odometry status, and publishes pose commands, velocity commands and the motion status
/// at a fixed rate of the bus's clock, and while somebody listens the motion to come.
class ControllerService {
 public:
  /// Throws std::invalid_argument naming the invalid option.
  ControllerService(const ControllerOptions& options, dds::Bus& bus);

 private:
  void OnPath(const nav_msgs::msg::Path& message);
  void OnOdometry(const nav_msgs::msg::Odometry& message);
  void OnOdometryStatus(const thalweg_msgs::msg::OdometryStatus& message);
  void OnExploration(const thalweg_msgs::msg::ExplorationStatus& message);
  void OnMapUpdate(const thalweg_msgs::msg::MapUpdate& message);
  void AskForMap();
  void OnTick();
  void PublishTrajectory(Time now);
  void LogStop(const Motion& motion);
  void PublishStatus(const Motion& motion, Time now);

  dds::Bus& bus_;
  Duration status_period_;
  PoseGate pose_gate_;
  dds::MapReplica map_;  ///< Empty unless paths are checked.
  const bool gimballed_;
  std::unique_ptr<MotionController> controller_;
  dds::Bus::Publisher<dds::topics::PoseCommand> pose_out_;
  dds::Bus::Publisher<dds::topics::VelocityCommand> velocity_out_;
  dds::Bus::Publisher<dds::topics::StampedVelocityCommand> stamped_velocity_out_;
  dds::Bus::Publisher<dds::topics::Trajectory> trajectory_out_;
  dds::Bus::Publisher<dds::topics::MotionStatus> status_out_;
  std::optional<dds::Bus::Publisher<dds::topics::MapRequests>> request_out_;
  Time odometry_stamp_;
  Time status_sent_;
  Time trajectory_sent_;
  MotionState last_state_ = MotionState::kIdle;
  Time last_path_;
  std::string last_reason_;  ///< Why the robot was stopped, as last logged.
};

}  // namespace thalweg::controller
