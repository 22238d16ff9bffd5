#include "services/controller/adapter/controller_service.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>

#include "common/dds/clock_problem.h"
#include "common/dds/convert.h"
#include "services/controller/adapter/text.h"
#include "services/controller/adapter/trajectory_message.h"

namespace thalweg::controller {
namespace {

namespace topics = dds::topics;

// How trajectories are published.
constexpr Duration kTrajectoryPeriod = std::chrono::milliseconds(200);
constexpr double kTrajectoryStep = 0.1;     // [s]
constexpr double kTrajectoryHorizon = 5.0;  // [s]

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

thalweg_msgs::msg::StopReason ReasonToIdl(StopReason reason) {
  switch (reason) {
    case StopReason::kNone:
      break;
    case StopReason::kNoPath:
      return thalweg_msgs::msg::STOP_NO_PATH;
    case StopReason::kNoPose:
      return thalweg_msgs::msg::STOP_NO_POSE;
    case StopReason::kNoMap:
      return thalweg_msgs::msg::STOP_NO_MAP;
    case StopReason::kEmptyPath:
      return thalweg_msgs::msg::STOP_EMPTY_PATH;
    case StopReason::kPathSilent:
      return thalweg_msgs::msg::STOP_PATH_SILENT;
    case StopReason::kGoingOn:
      return thalweg_msgs::msg::STOP_GOING_ON;
    case StopReason::kGoingBack:
      return thalweg_msgs::msg::STOP_GOING_BACK;
    case StopReason::kWentBack:
      return thalweg_msgs::msg::STOP_WENT_BACK;
    case StopReason::kPoseSilent:
      return thalweg_msgs::msg::STOP_POSE_SILENT;
    case StopReason::kLost:
      return thalweg_msgs::msg::STOP_LOST;
    case StopReason::kRetreating:
      return thalweg_msgs::msg::STOP_RETREATING;
    case StopReason::kOffPath:
      return thalweg_msgs::msg::STOP_OFF_PATH;
    case StopReason::kThroughSolid:
      return thalweg_msgs::msg::STOP_THROUGH_SOLID;
    case StopReason::kBlocked:
      return thalweg_msgs::msg::STOP_BLOCKED;
    case StopReason::kWaitingForArrival:
      return thalweg_msgs::msg::STOP_WAITING_FOR_ARRIVAL;
  }
  return thalweg_msgs::msg::STOP_NONE;
}

}  // namespace

ControllerService::ControllerService(const ControllerOptions& options, dds::Bus& bus)
    : bus_(bus),
      status_period_(FromSeconds(1.0 / options.status_rate)),
      pose_gate_(options.pose_gate),
      gimballed_(options.follower.robot.gimballed()),
      controller_(MakeController(options.type, options.follower)),
      pose_out_(bus.Advertise<topics::PoseCommand>()),
      velocity_out_(bus.Advertise<topics::VelocityCommand>()),
      stamped_velocity_out_(bus.Advertise<topics::StampedVelocityCommand>()),
      trajectory_out_(bus.Advertise<topics::Trajectory>()),
      status_out_(bus.Advertise<topics::MotionStatus>()) {
  bus.Subscribe<topics::Path>([this](const auto& message) { OnPath(message); });
  bus.Subscribe<topics::Odometry>([this](const auto& message) { OnOdometry(message); });
  bus.Subscribe<topics::OdometryStatus>([this](const auto& message) { OnOdometryStatus(message); });
  bus.Subscribe<topics::ExplorationStatus>([this](const auto& message) { OnExploration(message); });
  if (options.check_paths) {
    request_out_ = bus.Advertise<topics::MapRequests>();
    bus.Subscribe<topics::MapUpdates>([this](const auto& message) { OnMapUpdate(message); });
    bus.EveryWall(dds::MapReplica::kRequestPeriod, [this] { AskForMap(); });
  }
  bus.Every(FromSeconds(1.0 / options.rate), [this] { OnTick(); });
}

void ControllerService::OnPath(const nav_msgs::msg::Path& message) {
  Result<dds::StampedPath> path = dds::FromIdl(message);
  if (!path) return bus_.health().Reject<topics::Path>(path.error());
  controller_->SetPath(path->stamp, std::move(path->T_WBs), bus_.Now());
}

void ControllerService::OnOdometry(const nav_msgs::msg::Odometry& message) {
  const Result<dds::StampedPose> pose = dds::FromIdl(message);
  if (!pose) return bus_.health().Reject<topics::Odometry>(pose.error());
  if (pose->stamp < odometry_stamp_ && odometry_stamp_ - pose->stamp < kClockRestart) {
    return bus_.health().Drop<topics::Odometry>("older than the one before");
  }
  if (const auto problem = dds::ClockProblem(pose->stamp, bus_.Now()))
    return bus_.health().Drop<topics::Odometry>(*problem);
  odometry_stamp_ = pose->stamp;
  if (const auto jump = pose_gate_.Refuse(pose->T, pose->stamp)) {
    return bus_.health().Drop<topics::Odometry>(JumpText(*jump));
  }
  controller_->SetPose(pose->T, pose->stamp);
}

void ControllerService::OnOdometryStatus(const thalweg_msgs::msg::OdometryStatus& message) {
  const Result<Time> stamp = dds::FromIdl(message.header().stamp());
  if (!stamp) return bus_.health().Reject<topics::OdometryStatus>(stamp.error());
  controller_->SetLost(message.state() == thalweg_msgs::msg::ODOMETRY_LOST, *stamp);
}

/// A robot whose exploration has ended, or is paused, is where it is to be: silence does not make it go back.
void ControllerService::OnExploration(const thalweg_msgs::msg::ExplorationStatus& message) {
  controller_->SetStays(message.state() == thalweg_msgs::msg::EXPLORATION_DONE ||
                        message.state() == thalweg_msgs::msg::EXPLORATION_PAUSED);
}

void ControllerService::OnMapUpdate(const thalweg_msgs::msg::MapUpdate& message) {
  const auto applied = map_.Apply(message);
  if (!applied) return bus_.health().Reject<topics::MapUpdates>(applied.error());
  if (*applied) controller_->SetMap(map_.grid(), bus_.Now());
}

void ControllerService::AskForMap() {
  if (map_.missing()) request_out_->Write(map_.MakeRequest(bus_.Now(), "controller"));
}

void ControllerService::OnTick() {
  const Time now = bus_.Now();
  const auto start = std::chrono::steady_clock::now();
  const Motion motion = controller_->Step(now);
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  bus_.health().Timed("command", took.count());
  if (motion.command) {
    pose_out_.Write(dds::PoseStampedToIdl(now, motion.command->T_WB));
    const auto twist = dds::TwistToIdl(motion.command->v_WB_B, motion.command->w_WB_B);
    const MotionCommand level = motion.command->Leveled();
    velocity_out_.Write(gimballed_ ? dds::TwistToIdl(level.v_WB_B, level.w_WB_B) : twist);
    stamped_velocity_out_.Write(dds::TwistStampedToIdl(now, twist));
  }
  LogStop(motion);
  const bool changed = motion.state != last_state_ || motion.path_id != last_path_;
  const auto due = [&](Time sent, Duration period) { return changed || now < sent || now - sent >= period; };
  if (due(trajectory_sent_, kTrajectoryPeriod)) PublishTrajectory(now);
  if (due(status_sent_, status_period_)) PublishStatus(motion, now);
}

void ControllerService::PublishTrajectory(Time now) {
  trajectory_sent_ = now;
  if (trajectory_out_.readers() == 0) return;
  const auto start = std::chrono::steady_clock::now();
  const std::vector<TrajectoryPoint> points = controller_->Preview(kTrajectoryStep, kTrajectoryHorizon);
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  bus_.health().Timed("trajectory", took.count());
  if (!points.empty()) trajectory_out_.Write(TrajectoryToIdl(now, points));
}

void ControllerService::LogStop(const Motion& motion) {
  const bool stopped = motion.state == MotionState::kStopped && motion.path_id != Time{};
  const bool goes_on = motion.reason == StopReason::kGoingOn;
  // The explorer stops the robot whenever it replans
  const bool matters = goes_on || (stopped && motion.reason != StopReason::kEmptyPath);
  std::string reason = matters ? ReasonText(motion) : "";
  if (reason == last_reason_) return;
  if (!reason.empty()) spdlog::warn("{}{}", goes_on ? "" : "stopped: ", reason);
  if (stopped && motion.reason == StopReason::kThroughSolid) bus_.health().Reject<topics::Path>(reason);
  if (reason.empty()) spdlog::info("continues");
  last_reason_ = std::move(reason);
}

void ControllerService::PublishStatus(const Motion& motion, Time now) {
  thalweg_msgs::msg::MotionStatus message;
  message.header(dds::MakeHeader(now, dds::kMapFrame));
  message.path_stamp(dds::ToIdl(motion.path_id));
  message.state(StateToIdl(motion.state));
  message.stop_reason(ReasonToIdl(motion.reason));
  message.reason(ReasonText(motion));
  message.distance_done_m(motion.distance_done);
  message.distance_left_m(motion.distance_left);
  message.speed_mps(motion.speed);
  status_out_.Write(message);
  status_sent_ = now;
  last_state_ = motion.state;
  last_path_ = motion.path_id;
}

}  // namespace thalweg::controller
