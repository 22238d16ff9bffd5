#pragma once

#include "common/dds/bus.h"
#include "services/controller/adapter/options.h"
#include "services/controller/core/path_follower.h"

namespace thalweg::controller {

/// Runs the path follower on the bus: reads the path, odometry and odometry status, and publishes pose
/// commands, velocity commands and the motion status at a fixed rate of the bus's clock.
class ControllerService {
 public:
  ControllerService(const ControllerOptions& options, dds::Bus& bus);

 private:
  void OnPath(const nav_msgs::msg::Path& message);
  void OnOdometry(const nav_msgs::msg::Odometry& message);
  void OnOdometryStatus(const thalweg_msgs::msg::OdometryStatus& message);
  void OnTick();
  void PublishStatus(const Motion& motion, Time now);

  dds::Bus& bus_;
  Duration status_period_;
  PathFollower follower_;
  dds::Bus::Publisher<dds::topics::PoseCommand> pose_out_;
  dds::Bus::Publisher<dds::topics::VelocityCommand> velocity_out_;
  dds::Bus::Publisher<dds::topics::MotionStatus> status_out_;
  Time odometry_stamp_;
  Time status_sent_;
  MotionState last_state_ = MotionState::kIdle;
  Time last_path_;
};

}  // namespace thalweg::controller
