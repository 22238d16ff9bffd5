#include "services/controller/adapter/controller_service.h"

#include <chrono>

#include "common/dds/convert.h"

namespace thalweg::controller {
namespace {

namespace topics = dds::topics;

geometry_msgs::msg::Vector3 VectorToIdl(const Eigen::Vector3d& v) {
  geometry_msgs::msg::Vector3 message;
  message.x(v.x());
  message.y(v.y());
  message.z(v.z());
  return message;
}

thalweg_msgs::msg::MotionState StateToIdl(MotionState state) {
  switch (state) {
    case MotionState::kIdle:
      return thalweg_msgs::msg::MOTION_IDLE;
    case MotionState::kFollowing:
      return thalweg_msgs::msg::MOTION_FOLLOWING;
    case MotionState::kDone:
      return thalweg_msgs::msg::MOTION_DONE;
    case MotionState::kStopped:
      break;
  }
  return thalweg_msgs::msg::MOTION_STOPPED;
}

}  // namespace

ControllerService::ControllerService(const ControllerOptions& options, dds::Bus& bus)
    : bus_(bus),
      status_period_(FromSeconds(1.0 / options.status_rate)),
      follower_(options.follower),
      pose_out_(bus.Advertise<topics::PoseCommand>()),
      velocity_out_(bus.Advertise<topics::VelocityCommand>()),
      status_out_(bus.Advertise<topics::MotionStatus>()) {
  bus.Subscribe<topics::Path>([this](const auto& message) { OnPath(message); });
  bus.Subscribe<topics::Odometry>([this](const auto& message) { OnOdometry(message); });
  bus.Subscribe<topics::OdometryStatus>([this](const auto& message) { OnOdometryStatus(message); });
  bus.Every(FromSeconds(1.0 / options.rate), [this] { OnTick(); });
}

void ControllerService::OnPath(const nav_msgs::msg::Path& message) {
  Result<dds::StampedPath> path = dds::FromIdl(message);
  if (!path) return bus_.health().Reject<topics::Path>(path.error());
  follower_.SetPath(path->stamp, std::move(path->T_WBs), bus_.Now());
}

void ControllerService::OnOdometry(const nav_msgs::msg::Odometry& message) {
  const Result<dds::StampedPose> pose = dds::FromIdl(message);
  if (!pose) return bus_.health().Reject<topics::Odometry>(pose.error());
  if (pose->stamp < odometry_stamp_ && odometry_stamp_ - pose->stamp < kClockRestart) {
    return bus_.health().Drop<topics::Odometry>("older than the one before");
  }
  odometry_stamp_ = pose->stamp;
  follower_.SetPose(pose->T, pose->stamp);
}

void ControllerService::OnOdometryStatus(const thalweg_msgs::msg::OdometryStatus& message) {
  const Result<Time> stamp = dds::FromIdl(message.header().stamp());
  if (!stamp) return bus_.health().Reject<topics::OdometryStatus>(stamp.error());
  follower_.SetLost(message.state() == thalweg_msgs::msg::ODOMETRY_LOST, *stamp);
}

void ControllerService::OnTick() {
  const Time now = bus_.Now();
  const auto start = std::chrono::steady_clock::now();
  const Motion motion = follower_.Step(now);
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  bus_.health().Timed("command", took.count());
  if (motion.command) {
    pose_out_.Write(dds::PoseStampedToIdl(now, motion.command->T_WB));
    geometry_msgs::msg::Twist twist;
    twist.linear(VectorToIdl(motion.command->v_WB_B));
    twist.angular(VectorToIdl(motion.command->w_WB_B));
    velocity_out_.Write(twist);
  }
  const bool changed = motion.state != last_state_ || motion.path_id != last_path_;
  if (changed || now < status_sent_ || now - status_sent_ >= status_period_) PublishStatus(motion, now);
}

void ControllerService::PublishStatus(const Motion& motion, Time now) {
  thalweg_msgs::msg::MotionStatus message;
  message.header(dds::MakeHeader(now, dds::kMapFrame));
  message.path_stamp(dds::ToIdl(motion.path_id));
  message.state(StateToIdl(motion.state));
  message.reason(motion.reason);
  message.distance_done_m(motion.distance_done);
  message.distance_left_m(motion.distance_left);
  message.speed_mps(motion.speed);
  status_out_.Write(message);
  status_sent_ = now;
  last_state_ = motion.state;
  last_path_ = motion.path_id;
}

}  // namespace thalweg::controller
