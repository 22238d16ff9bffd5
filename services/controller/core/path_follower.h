#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"
#include "common/geometry/robot_model.h"
#include "services/controller/core/cut_off.h"
#include "services/controller/core/motion_controller.h"
#include "services/controller/core/orientation.h"
#include "services/controller/core/path_check.h"
#include "services/controller/core/retreat.h"
#include "services/controller/core/smoother.h"
#include "services/controller/core/track.h"

namespace thalweg::controller {

/// Leads the robot along a path by moving a pose command exactly along its polyline, within limits of speed,
/// acceleration and turn rate. If jerk is limited, too, the command's position is the mean of that over the
/// last moments (see Smoother).
///
/// Position: the speed along the arc follows a trapezoidal profile that slows down at each corner (see
/// Track). Orientation: the command rotates by the shortest arc toward the orientation of the next vertex,
/// with limited rate and acceleration (see Orientation); the position waits for it only at the end of the
/// path. A robot that must face where it moves is turned along the path instead, on the spot at sharp
/// corners, and takes the last vertex's orientation when it has arrived. Its velocity command has no sideways
/// part: it steers back to the pose command [Kanayama et al., A stable tracking control method for an
/// autonomous mobile robot, ICRA 1990], critically damped. One that cannot turn on the spot drives back along
/// segments whose poses look back, turns no tighter than it can, and joins a path only where it faces along
/// it. It has arrived where neither forward nor back brings it nearer, since it cannot do better.
///
/// Safety: when path or pose messages stop arriving, the command brakes so that it stands still at most
/// `silence` after the last message. The command is never farther ahead of the robot than the robot's braking
/// distance plus its delay, so it waits for a robot that does not follow, and before that no farther around a
/// corner than a straight line from the robot may cut it. When the robot is reported to be
/// lost, the command brakes and then retreats a little (see Retreat). When the path stays silent, the robot
/// may go back on the path that it came (see CutOff), like along any other, until a path is heard again. Or
/// it does not stop at all, but follows the path to its end (OnCutOff::kGoOn), as long as paths are checked
/// against a map that keeps arriving. If paths are checked, it does not move before there is a map, nor
/// beyond what has been checked against it (see PathCheck).
///
/// Threading: one thread.
class PathFollower final : public MotionController {
 public:
  struct Options {
    RobotModel robot = {};          ///< Its rates, how it moves, and its jerk, if that is limited.
    double emergency_factor = 2.5;  ///< Emergency braking relative to the robot's accelerations.
    double corner_step =
        TrackLimits{}.corner_step;  ///< [m/s] Largest change of the velocity vector at a corner.
    double silence = 0.5;           ///< [s] Age of the last path or pose at which the command stands still.
    double position_tolerance = 0.03;  ///< [m] Greatest distance of the robot from the last pose of the path.
    double angle_tolerance = 0.05;     ///< [rad] Likewise.
    double path_tolerance = 0.3;       ///< [m] A robot farther from the path has left it.
    /// [m] By which a robot that lags behind the command, and moves straight to it, may cut a corner.
    double corner_cut = 0.02;
    double delay = 0.2;     ///< [s] Longest time from a command to the odometry that shows it.
    double patience = 1.0;  ///< [s] Wait at the end of the path for a robot that does not arrive.
    /// [1/s] Gain from the robot's lag behind the pose command to the velocity command.
    double feedback = 1.0;
    Retreat::Options retreat;
    CutOff::Options cut_off = {};
    std::optional<PathCheck::Body> checked_body = {};  ///< Body for which paths are checked; empty = not.
    double map_silence = 1.0;  ///< [s] Age of the last map update beyond which a robot that is cut off stops.
  };
  /// Throws std::invalid_argument naming the invalid option.
  explicit PathFollower(const Options& options);

  void SetPath(Time id, std::vector<RigidTransform> T_WBs, Time now) override;
  void SetPose(const RigidTransform& T_WB, Time stamp) override;
  void SetLost(bool lost, Time stamp) override;
  void SetMap(const OccupancyGrid& map, Time now) override;
  void SetStays(bool stays) override { stays_ = stays; }
  Motion Step(Time now) override;
  std::vector<TrajectoryPoint> Preview(double step, double horizon) const override;

  const Options& options() const { return options_; }
  /// Whether the command neither moves nor turns.
  bool standing() const;

 private:
  struct Path {
    Time id;
    std::vector<RigidTransform> T_WBs;
    double length = 0.0;  ///< [m]
  };
  struct Pose {
    Time stamp;
    RigidTransform T_WB;
  };

  double StepLength(Time now);
  bool Silent(Time heard, Time now) const;
  bool Lost(Time now) const;
  bool MayGoOn(Time now) const;
  StopReason Emergency(Time now);
  /// The path that is followed: the explorer's, or the path back.
  const Path& path() const { return path_back_ ? *path_back_ : *path_; }
  void BeginPathBack(Time now);
  void EndPathBack(Time now);
  StopReason TryJoin();
  void CheckTrack();
  /// Whether the robot turns only in curves.
  bool in_curves() const { return !options_.robot.turns_on_the_spot(); }
  StopReason Obstacle() const;
  double CheckedSpeed() const;
  void Advance(StopReason emergency, double dt);
  void BrakeHard(double dt);
  void GoBack(double dt);
  void Drive(double dt);
  Track::Nearest RobotOnTrack() const;
  double Room() const;
  void Turn(double dt);
  Eigen::Quaterniond WantedOrientation() const;
  bool MustTurnFirst() const;
  std::optional<std::vector<RigidTransform>> Joined() const;
  void BeginAt(const Track& track);
  void Travel(double next_speed, double dt);
  void StandAtRobot();
  void Place(const Eigen::Vector3d& p_W);
  Eigen::Vector3d CommandedPosition() const;
  Eigen::Vector3d CommandedVelocity() const;
  void HearAgain(Time now);
  TrajectoryPoint Moment(double time) const;
  bool LeftPath() const;
  bool Blocked() const;
  bool CommandAtEnd() const;
  bool RobotAtEnd() const;
  void Judge(Time now);
  Motion Report() const;
  MotionCommand MakeCommand() const;
  Eigen::Vector3d Limited(const Eigen::Vector3d& w_B) const;
  void Steer(const Eigen::Vector3d& behind_B, double turned_away, MotionCommand& command) const;

  double Lead() const;       ///< [m] Distance from the robot to the command.
  double AngleLead() const;  ///< [rad]

  Options options_;
  double max_lead_;        ///< [m]
  double max_angle_lead_;  ///< [rad]

  std::optional<Path> path_;
  /// Whether track_ follows path_; if not, a connection onto path_ is still to be found.
  bool joined_ = false;
  std::optional<Pose> pose_;
  Time path_heard_;
  bool path_silent_ = false;  ///< Set until the next path message.
  CutOff cut_off_;
  std::optional<Path> path_back_;  ///< Set while the robot goes back because the path is silent.
  double path_back_left_ = 0.0;    ///< [m]
  bool stays_ = false;

  std::optional<PathCheck> check_;  ///< Checks track_, if paths are checked.
  const OccupancyGrid* map_ = nullptr;
  Time map_heard_;
  bool recheck_ = false;   ///< The track or the map has changed.
  bool previews_ = false;  ///< This is a copy that only looks ahead, as far as its track has been checked.
  bool pose_silent_ = false;
  std::optional<Time> last_step_;
  double dt_ = 0.0;  ///< [s] Length of the last step.
  std::optional<Time> waiting_since_;

  // The command, which lies on track_ if there is one.
  bool has_command_ = false;
  std::optional<Track> track_;
  double s_ = 0.0;                                 ///< [m]
  double speed_ = 0.0;                             ///< [m/s]
  Eigen::Vector3d p_W_ = Eigen::Vector3d::Zero();  ///< Before it is smoothed.
  std::optional<Smoother> smoother_;               ///< Follows p_W_, if jerk is limited.
  Orientation orientation_;

  Retreat retreat_;
  std::optional<Time> lost_;           ///< Time of the last report.
  std::optional<MotionCommand> back_;  ///< Set while the robot retreats.

  MotionState state_ = MotionState::kIdle;
  StopReason reason_ = StopReason::kNone;
};

}  // namespace thalweg::controller
