#include "services/controller/core/path_follower.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "common/base/require.h"
#include "common/geometry/attitude.h"
#include "common/geometry/polyline.h"
#include "services/controller/core/clamp_norm.h"

namespace thalweg::controller {
namespace {

constexpr double kLongestStep = 0.1;  // [s]
constexpr double kNothing = 1e-6;     // [m/s, rad, rad/s] Less than this counts as standing or arrived.
// A robot that must face where it moves sets out when it is turned away from there by no more than kAligned,
// and stops to turn at more than kAstray, which curves do not reach.
constexpr double kAligned = 0.02;                    // [rad]
constexpr double kAstray = 1.5 * kSharpestInCurves;  // [rad]
constexpr double kSlowestSteering = 0.1;             // [m/s] Below, it steers less, since it gets nowhere.

/// Rotation vector [rad] of the shortest arc.
Eigen::Vector3d LogOf(const Eigen::Quaterniond& q) {
  const Eigen::AngleAxisd turn(q);
  return turn.angle() * turn.axis();
}

/// Highest speed from which the robot can still stop within the distance `left`.
double BrakingSpeed(double left, double deceleration) {
  return std::sqrt(2.0 * deceleration * std::max(0.0, left));
}

}  // namespace

PathFollower::PathFollower(const Options& options)
    : options_(options),
      max_lead_(options.robot.max_speed * (0.5 * options.robot.max_speed / options.robot.max_acceleration +
                                           options.delay + 0.5 * options.robot.smoothing())),
      max_angle_lead_(
          options.robot.greatest_turn_rate() *
          (0.5 * options.robot.greatest_turn_rate() / options.robot.max_turn_acceleration + options.delay)),
      cut_off_(options.cut_off),
      orientation_({.rate = options.robot.max_turn_rate,
                    .acceleration = options.robot.max_turn_acceleration,
                    .gimbal_rate = options.robot.gimballed() ? options.robot.max_gimbal_rate : 0.0}),
      retreat_(options.retreat) {
  if (options.checked_body) check_.emplace(*options.checked_body);
  if (options.robot.smoothing() > 0.0) smoother_.emplace(options.robot.smoothing());
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  Require(positive(options.robot.max_speed), "max_speed", options.robot.max_speed, "> 0");
  Require(positive(options.robot.max_acceleration), "max_acceleration", options.robot.max_acceleration,
          "> 0");
  Require(std::isfinite(options.robot.max_jerk) && options.robot.max_jerk >= 0.0, "max_jerk",
          options.robot.max_jerk, ">= 0");
  Require(options.robot.turns_on_the_spot() || positive(options.robot.min_turning_radius),
          "min_turning_radius", options.robot.min_turning_radius, "> 0");
  Require(positive(options.robot.max_turn_rate), "max_turn_rate", options.robot.max_turn_rate, "> 0");
  Require(positive(options.robot.max_turn_acceleration), "max_turn_acceleration",
          options.robot.max_turn_acceleration, "> 0");
  Require(options.emergency_factor >= 1.0, "emergency_factor", options.emergency_factor, ">= 1");
  Require(positive(options.corner_step), "corner_step", options.corner_step, "> 0");
  Require(positive(options.silence), "silence", options.silence, "> 0");
  Require(positive(options.position_tolerance), "position_tolerance", options.position_tolerance, "> 0");
  Require(positive(options.angle_tolerance), "angle_tolerance", options.angle_tolerance, "> 0");
  Require(positive(options.path_tolerance), "path_tolerance", options.path_tolerance, "> 0");
  Require(options.cut_off.after >= options.silence, "cut_off.after", options.cut_off.after, ">= silence");
  if (options.cut_off.action == OnCutOff::kGoOn && !options.checked_body)
    throw std::invalid_argument("cut_off.action: a robot that goes on must check its path");
  Require(options.map_silence >= 0.0, "map_silence", options.map_silence, ">= 0");
  Require(options.corner_cut >= 0.0, "corner_cut", options.corner_cut, ">= 0");
  Require(options.delay >= 0.0, "delay", options.delay, ">= 0");
  Require(options.patience >= 0.0, "patience", options.patience, ">= 0");
  Require(options.feedback >= 0.0, "feedback", options.feedback, ">= 0");
}

void PathFollower::SetPath(Time id, std::vector<RigidTransform> T_WBs, Time now) {
  path_heard_ = now;
  path_silent_ = false;
  EndPathBack(now);
  cut_off_.Heard(now);
  if (path_ && path_->id == id && path_->T_WBs.empty() == T_WBs.empty()) return;
  const double length = PathLength(T_WBs);
  path_ = Path{.id = id, .T_WBs = std::move(T_WBs), .length = length};
  joined_ = false;
}

void PathFollower::SetPose(const RigidTransform& T_WB, Time stamp) {
  pose_ = Pose{.stamp = stamp, .T_WB = T_WB};
  pose_silent_ = false;
  if (!path_back_ && !Lost(stamp)) cut_off_.Note(T_WB);
}

void PathFollower::SetLost(bool lost, Time stamp) {
  lost_ = lost ? std::optional(stamp) : std::nullopt;
}

void PathFollower::SetMap(const OccupancyGrid& map, Time now) {
  map_ = &map;
  map_heard_ = now;
  recheck_ = true;
}

/// An old report is ignored, because whoever sent it may be gone.
bool PathFollower::Lost(Time now) const {
  return lost_ && Seconds(now - *lost_) < options_.silence;
}

/// Whether the path is followed to its end although nobody repeats it.
bool PathFollower::MayGoOn(Time now) const {
  return options_.cut_off.action == OnCutOff::kGoOn && !stays_ && map_ != nullptr &&
         Seconds(now - map_heard_) <= options_.map_silence;
}

Motion PathFollower::Step(Time now) {
  dt_ = StepLength(now);
  // Else a pose from a clock that is ahead, or was reset, would hide the silence after it.
  if (pose_) pose_->stamp = std::min(pose_->stamp, now);
  if (lost_) lost_ = std::min(*lost_, now);
  BeginPathBack(now);
  const bool arrived = joined_ && state_ == MotionState::kDone && !Lost(now);
  back_.reset();
  if (path_ && pose_ && !arrived) {
    if (joined_) CheckTrack();
    const StopReason emergency = Emergency(now);
    Advance(emergency, dt_);
    if (smoother_ && has_command_) smoother_->Move(p_W_, dt_);
    if (state_ == MotionState::kFollowing) Judge(now);
    const bool goes_on = !path_silent_ && Seconds(now - path_heard_) >= options_.silence;
    if (goes_on && state_ == MotionState::kFollowing && reason_ == StopReason::kNone)
      reason_ = StopReason::kGoingOn;
    if (Lost(now) && !path_silent_ && standing()) GoBack(dt_);
    if (has_command_ && !back_)
      retreat_.Note(MakeTransform(orientation_.q_WB().toRotationMatrix(), CommandedPosition()));
    if (path_back_ && joined_) path_back_left_ = track_->length() - s_;
    if (path_back_ && joined_ && state_ == MotionState::kDone) {
      EndPathBack(now);
      state_ = MotionState::kStopped;
      reason_ = StopReason::kWentBack;
    }
  }
  return Report();
}

double PathFollower::StepLength(Time now) {
  if (last_step_ && now < *last_step_) {  // the clock was reset
    path_heard_ = std::min(path_heard_, now);
    map_heard_ = std::min(map_heard_, now);
  }
  const double dt = last_step_ ? Seconds(now - *last_step_) : 0.0;
  last_step_ = now;
  return std::clamp(dt, 0.0, kLongestStep);
}

/// Whether to start braking, so that the command stands still when the last message is `silence` old.
bool PathFollower::Silent(Time heard, Time now) const {
  const double braking = std::max(
      speed_ / (options_.robot.max_acceleration * options_.emergency_factor),
      orientation_.rate_B().norm() / (options_.robot.max_turn_acceleration * options_.emergency_factor));
  return Seconds(now - heard) + braking + options_.robot.smoothing() + 2.0 * dt_ >= options_.silence;
}

void PathFollower::BeginPathBack(Time now) {
  const bool is_cut_off = path_ && Seconds(now - path_heard_) >= options_.silence;
  if (!is_cut_off || path_back_ || stays_ || !standing() || !pose_ || Silent(pose_->stamp, now) || Lost(now))
    return;
  auto T_WBs = cut_off_.PathBack(now);
  if (!T_WBs) return;
  path_silent_ = true;
  path_back_left_ = PathLength(*T_WBs);
  path_back_ = Path{.id = path_->id, .T_WBs = std::move(*T_WBs), .length = path_back_left_};
  joined_ = false;
}

void PathFollower::EndPathBack(Time now) {
  if (!path_back_) return;
  cut_off_.EndPathBack(path_back_left_, now);
  path_back_.reset();
  joined_ = false;
}

StopReason PathFollower::Emergency(Time now) {
  path_silent_ = path_silent_ || (Silent(path_heard_, now) && !MayGoOn(now));
  pose_silent_ = pose_silent_ || Silent(pose_->stamp, now);
  if (path_silent_ && !path_back_) return cut_off_.place() ? StopReason::kWentBack : StopReason::kPathSilent;
  if (path().T_WBs.empty()) return StopReason::kEmptyPath;
  if (Lost(now)) return StopReason::kLost;
  if (pose_silent_) return StopReason::kPoseSilent;
  if (check_ && map_ == nullptr) return StopReason::kNoMap;
  return joined_ ? Obstacle() : StopReason::kNone;
}

void PathFollower::Advance(StopReason emergency, double dt) {
  reason_ = emergency;
  if (reason_ == StopReason::kNone && joined_ && LeftPath()) {
    StandAtRobot();
    joined_ = false;
  }
  if (reason_ == StopReason::kNone && !joined_) reason_ = TryJoin();
  if (reason_ != StopReason::kNone) {
    BrakeHard(dt);
    state_ = MotionState::kStopped;
    return;
  }
  state_ = MotionState::kFollowing;
  if (joined_) {
    Drive(dt);
  } else {  // still on the previous path, too fast to switch
    Travel(std::max(0.0, speed_ - options_.robot.max_acceleration * dt), dt);
  }
  Turn(dt);
}

/// Switches to path_ once the speed allows it. Returns the reason when that is impossible, otherwise kNone.
StopReason PathFollower::TryJoin() {
  const bool robot_elsewhere = Lead() > options_.position_tolerance || AngleLead() > options_.angle_tolerance;
  if (!has_command_ || (standing() && robot_elsewhere)) StandAtRobot();
  auto joined = Joined();
  if (!joined) return speed_ > 0.0 ? StopReason::kNone : StopReason::kOffPath;
  if (options_.robot.gimballed()) {
    for (RigidTransform& T_WB : *joined) T_WB = Held(options_.robot, T_WB);
  }
  Track track(*joined,
              {.max_speed = options_.robot.max_speed,
               .max_acceleration = options_.robot.max_acceleration,
               .corner_step = options_.corner_step,
               .facing_turn_rate = options_.robot.faces_travel() ? options_.robot.max_turn_rate : 0.0});
  if (speed_ > 0.0) {
    const Eigen::Vector3d bend = track.DirectionAt(0.0) - track_->DirectionAt(s_);
    if (speed_ > track.SpeedLimitAt(0.0) + kNothing || speed_ * bend.norm() > options_.corner_step)
      return StopReason::kNone;
  }
  track_ = std::move(track);
  s_ = 0.0;
  joined_ = true;
  waiting_since_.reset();
  recheck_ = true;
  if (in_curves()) BeginAt(*track_);
  CheckTrack();
  return Obstacle();
}

/// Goes on from the beginning of a track that does not begin where the command is.
void PathFollower::BeginAt(const Track& track) {
  if ((track.PositionAt(0.0) - p_W_).norm() > options_.position_tolerance)
    retreat_ = Retreat(options_.retreat);  // what was noted does not lead there
  Place(track.PositionAt(0.0));
  orientation_.Place(track.OrientationAt(0.0));
}

/// What is left of path() from the command on; with what leads there, unless the robot steers onto it. Empty
/// if that is too far away.
std::optional<std::vector<RigidTransform>> PathFollower::Joined() const {
  if (!in_curves()) return JoinPath(p_W_, path().T_WBs, options_.path_tolerance);
  auto rest = RestOfPath(p_W_, path().T_WBs, options_.path_tolerance);
  const bool faces_along = rest && AngleBetween(pose_->T_WB, rest->front()) <= kAstray;
  return faces_along ? rest : std::nullopt;
}

void PathFollower::CheckTrack() {
  if (!check_ || map_ == nullptr || (previews_ && !recheck_)) return;
  if (std::exchange(recheck_, false)) check_->Restart(*map_, *track_, s_);
  check_->Continue(*map_, *track_);
}

/// Why the robot must not go on along the track, as far as it has been checked; kNone if it may.
StopReason PathFollower::Obstacle() const {
  return check_ && check_->obstacle_W() ? StopReason::kThroughSolid : StopReason::kNone;
}

/// Highest speed from which the robot can stop before what has not been checked.
double PathFollower::CheckedSpeed() const {
  if (!check_ || check_->clear_to() >= track_->length()) return options_.robot.max_speed;
  return BrakingSpeed(check_->clear_to() - s_ - options_.robot.max_speed * dt_,
                      options_.robot.max_acceleration);
}

void PathFollower::BrakeHard(double dt) {
  if (!has_command_) return;
  const double f = options_.emergency_factor;
  Travel(std::max(0.0, speed_ - f * options_.robot.max_acceleration * dt), dt);
  if (in_curves()) return Turn(dt);
  if (dt > 0.0) orientation_.Brake(f, dt);
}

void PathFollower::GoBack(double dt) {
  if (!has_command_ || dt <= 0.0) return;
  const RigidTransform T_WB = MakeTransform(orientation_.q_WB().toRotationMatrix(), p_W_);
  const auto back = retreat_.Back(T_WB, dt);
  if (!back) return;
  joined_ = false;
  track_.reset();
  Place(back->translation());
  orientation_.Place(Eigen::Quaterniond(back->linear()));
  back_ = MotionCommand{.T_WB = *back,
                        .v_WB_B = back->linear().transpose() * (p_W_ - T_WB.translation()) / dt,
                        .w_WB_B = LogOf(Eigen::Quaterniond(T_WB.linear().transpose() * back->linear())) / dt,
                        .T_WB_of_velocities = *back};
  reason_ = StopReason::kRetreating;
}

void PathFollower::Drive(double dt) {
  const double a = options_.robot.max_acceleration;
  const double by_lead = BrakingSpeed(Room(), a);
  const double next =
      MustTurnFirst() ? 0.0 : std::min({track_->NextSpeed(s_, speed_, dt), by_lead, CheckedSpeed()});
  Travel(std::max({next, speed_ - a * dt, 0.0}), dt);
}

/// Where on the part of the track that the robot may be at it is.
Track::Nearest PathFollower::RobotOnTrack() const {
  const double slack = options_.path_tolerance;
  return track_->NearestTo(pose_->T_WB.translation(), s_ - max_lead_ - slack, s_ + slack);
}

/// [m] How much farther the command may go before the robot follows. One beside the track may be farther from
/// corners, too.
double PathFollower::Room() const {
  const double by_lead = max_lead_ - Lead();
  if (by_lead <= 0.0) return by_lead;
  const Track::Nearest robot = RobotOnTrack();
  if (robot.s >= s_) return by_lead;
  return track_->ReachWithoutCutting(pose_->T_WB.translation(), robot.s, s_, s_ + by_lead,
                                     options_.corner_cut + robot.distance) -
         s_;
}

Eigen::Quaterniond PathFollower::WantedOrientation() const {
  if (in_curves()) return track_->OrientationAt(s_);
  if (!options_.robot.faces_travel() || s_ >= track_->length()) return track_->OrientationAhead(s_);
  const Eigen::Vector3d ahead_W = track_->FacingAt(s_);
  return Eigen::Quaterniond(RotationFromYawPitch(std::atan2(ahead_W.y(), ahead_W.x()), 0.0));
}

bool PathFollower::MustTurnFirst() const {
  if (!options_.robot.faces_travel() || in_curves() || s_ >= track_->length()) return false;
  return orientation_.q_WB().angularDistance(WantedOrientation()) > (speed_ == 0.0 ? kAligned : kAstray);
}

void PathFollower::Turn(double dt) {
  if (!track_ || dt <= 0.0) return;
  if (in_curves()) return orientation_.TurnWith(WantedOrientation(), dt);
  orientation_.TurnTo(WantedOrientation(),
                      BrakingSpeed(max_angle_lead_ - AngleLead(), options_.robot.max_turn_acceleration), dt);
}

void PathFollower::Travel(double next_speed, double dt) {
  if (!track_) return;
  const double stop = track_->NextStop(s_);
  s_ += 0.5 * (speed_ + next_speed) * dt;
  speed_ = next_speed;
  if (s_ > stop - 1e-9) {
    s_ = stop;
    speed_ = 0.0;
  }
  p_W_ = track_->PositionAt(s_);
}

void PathFollower::StandAtRobot() {
  has_command_ = true;
  Place(pose_->T_WB.translation());
  orientation_.Place(Eigen::Quaterniond(pose_->T_WB.linear()));
  speed_ = 0.0;
  track_.reset();
  s_ = 0.0;
}

void PathFollower::Place(const Eigen::Vector3d& p_W) {
  p_W_ = p_W;
  if (smoother_) smoother_->Restart(p_W);
}

Eigen::Vector3d PathFollower::CommandedPosition() const {
  return smoother_ ? smoother_->position() : p_W_;
}

Eigen::Vector3d PathFollower::CommandedVelocity() const {
  if (smoother_) return smoother_->velocity();
  return track_ ? Eigen::Vector3d(speed_ * track_->DirectionAt(s_)) : Eigen::Vector3d::Zero();
}

bool PathFollower::standing() const {
  return speed_ == 0.0 && orientation_.rate_B().norm() < kNothing &&
         (!smoother_ || !has_command_ || smoother_->stands());
}

bool PathFollower::LeftPath() const {
  // A robot that lags behind is still on what came before the track, if that has just begun.
  const double before = std::max(0.0, (p_W_ - CommandedPosition()).norm() - s_);
  return RobotOnTrack().distance > options_.path_tolerance + before;
}

/// Whether the command is as far ahead of the robot as allowed.
bool PathFollower::Blocked() const {
  constexpr double kSlow = 0.02;  // [m/s, rad/s]
  return BrakingSpeed(joined_ ? Room() : max_lead_ - Lead(), options_.robot.max_acceleration) < kSlow ||
         BrakingSpeed(max_angle_lead_ - AngleLead(), options_.robot.max_turn_acceleration) < kSlow;
}

bool PathFollower::CommandAtEnd() const {
  return s_ >= track_->length() && standing() &&
         orientation_.q_WB().angularDistance(track_->end_orientation()) < kNothing;
}

bool PathFollower::RobotAtEnd() const {
  if (in_curves()) {
    const Eigen::Vector3d left_B = pose_->T_WB.inverse() * track_->end();
    return std::abs(left_B.x()) <= options_.position_tolerance && left_B.norm() <= options_.path_tolerance;
  }
  return (track_->end() - pose_->T_WB.translation()).norm() <= options_.position_tolerance &&
         track_->end_orientation().angularDistance(Eigen::Quaterniond(pose_->T_WB.linear())) <=
             options_.angle_tolerance;
}

void PathFollower::Judge(Time now) {
  const bool waiting = joined_ && CommandAtEnd();
  if (!waiting) waiting_since_.reset();
  if (waiting && !waiting_since_) waiting_since_ = now;
  if (waiting && RobotAtEnd()) {
    state_ = MotionState::kDone;
    orientation_.Stop();
  } else if ((waiting && Seconds(now - *waiting_since_) > options_.patience) || (!waiting && Blocked())) {
    state_ = MotionState::kStopped;
    reason_ = StopReason::kBlocked;
  } else if (waiting) {
    reason_ = StopReason::kWaitingForArrival;
  }
}

Motion PathFollower::Report() const {
  Motion motion;
  motion.state = state_;
  motion.reason = reason_;
  motion.speed = smoother_ && has_command_ ? smoother_->velocity().norm() : speed_;
  if (!path_) {
    motion.reason = StopReason::kNoPath;
    return motion;
  }
  motion.path_id = path_->id;
  motion.distance_done = joined_ ? s_ : 0.0;
  motion.distance_left = joined_ ? track_->length() - s_ : path().length;
  if (path_back_ && state_ == MotionState::kFollowing) {
    motion.state = MotionState::kStopped;  // before the end of the explorer's path
    motion.reason = StopReason::kGoingBack;
  }
  if (!pose_) {
    motion.state = MotionState::kStopped;
    motion.reason = StopReason::kNoPose;
  }
  if (motion.reason == StopReason::kGoingBack || motion.reason == StopReason::kWentBack)
    motion.back = cut_off_.place();
  if (motion.reason == StopReason::kThroughSolid) motion.obstacle_W = check_->obstacle_W();
  if (has_command_) motion.command = MakeCommand();
  return motion;
}

MotionCommand PathFollower::MakeCommand() const {
  if (back_) return *back_;
  const Eigen::Quaterniond q_BW = Eigen::Quaterniond(pose_->T_WB.linear()).conjugate();
  const Eigen::Vector3d p_W = CommandedPosition();
  MotionCommand command{.T_WB = MakeTransform(orientation_.q_WB().toRotationMatrix(), p_W),
                        .T_WB_of_velocities = pose_->T_WB};
  if (options_.robot.faces_travel()) {
    Steer(q_BW * (p_W - pose_->T_WB.translation()), LogOf(q_BW * orientation_.q_WB()).z(), command);
    return command;
  }
  Eigen::Vector3d v_W = CommandedVelocity();
  Eigen::Vector3d w_B = q_BW * (orientation_.q_WB() * orientation_.rate_B());
  if (state_ == MotionState::kFollowing) {
    v_W += options_.feedback * (p_W - pose_->T_WB.translation());
    w_B += options_.feedback * LogOf(q_BW * orientation_.q_WB());
  }
  command.v_WB_B = ClampNorm(q_BW * v_W, options_.robot.max_speed);
  command.w_WB_B = Limited(w_B);
  return command;
}

/// A turn within the limits of the body, or of the robot and its gimbal. @param w_B  [rad/s] In the body's
/// frame.
Eigen::Vector3d PathFollower::Limited(const Eigen::Vector3d& w_B) const {
  if (!options_.robot.gimballed()) return ClampNorm(w_B, options_.robot.max_turn_rate);
  const Eigen::Matrix3d R_LB = Leveled(pose_->T_WB).linear().transpose() * pose_->T_WB.linear();
  const Eigen::Vector3d w_L = R_LB * w_B;
  const double turn = options_.robot.max_turn_rate;
  const double pitch = options_.robot.max_gimbal_rate;
  return R_LB.transpose() *
         Eigen::Vector3d(0.0, std::clamp(w_L.y(), -pitch, pitch), std::clamp(w_L.z(), -turn, turn));
}

void PathFollower::Steer(const Eigen::Vector3d& behind_B, double turned_away, MotionCommand& command) const {
  const double along = in_curves() && track_ && track_->LeadsBackAt(s_) ? -speed_ : speed_;
  double forward = along * std::cos(turned_away);
  double turn = orientation_.rate_B().z();
  if (state_ == MotionState::kFollowing) {
    const double gain = options_.feedback;
    const double speed = std::max(speed_, kSlowestSteering);
    forward += gain * behind_B.x();
    turn += 2.0 * gain * turned_away + gain * gain * behind_B.y() * along / (speed * speed);
  }
  const RobotModel& robot = options_.robot;
  command.v_WB_B.x() = std::clamp(forward, -robot.max_speed, robot.max_speed);
  double fastest = robot.max_turn_rate;
  if (in_curves()) fastest = std::min(fastest, std::abs(command.v_WB_B.x()) / robot.min_turning_radius);
  command.w_WB_B.z() = std::clamp(turn, -fastest, fastest);
}

double PathFollower::Lead() const {
  return (p_W_ - pose_->T_WB.translation()).norm();
}

double PathFollower::AngleLead() const {
  return orientation_.q_WB().angularDistance(Eigen::Quaterniond(pose_->T_WB.linear()));
}

}  // namespace thalweg::controller
