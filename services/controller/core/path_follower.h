#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"
#include "services/controller/core/retreat.h"
#include "services/controller/core/track.h"

namespace thalweg::controller {

/// Where the robot shall be now, and how it shall move.
struct MotionCommand {
  RigidTransform T_WB;
  Eigen::Vector3d v_WB_B = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Vector3d w_WB_B = Eigen::Vector3d::Zero();  ///< [rad/s]
};

enum class MotionState : std::uint8_t { kIdle, kFollowing, kDone, kStopped };

struct Motion {
  MotionState state = MotionState::kIdle;
  std::string reason;                    ///< Of a stop, or what is waited for.
  Time path_id;                          ///< The epoch when there is no path.
  double distance_done = 0.0;            ///< [m] along the path since it was joined.
  double distance_left = 0.0;            ///< [m]
  double speed = 0.0;                    ///< [m/s] commanded
  std::optional<MotionCommand> command;  ///< Nothing until there has been a path and a pose.
};

/// Leads the robot along a path: exactly along its polyline, within speed, acceleration and turn limits.
///
/// Position: speed along the arc with a trapezoid profile, slow enough at each corner (see Track).
/// Orientation: turns towards the one that the next vertex asks for, by the shortest arc, with limited rate
/// and acceleration; the position waits for it only at the end. Safety: when path or pose fall silent it
/// brakes so that the command stands still `silence` after the last message at the latest. The command is
/// never further ahead of the robot than the robot needs to brake, plus its delay; a robot that does not
/// follow is waited for. A robot that is told to be lost brakes and goes back a little (see Retreat).
/// Threading: one thread.
class PathFollower {
 public:
  struct Options {
    double max_speed = 0.5;              ///< [m/s]
    double max_acceleration = 1.0;       ///< [m/s^2]
    double max_turn_rate = 1.6;          ///< [rad/s]
    double max_turn_acceleration = 4.0;  ///< [rad/s^2]
    double emergency_factor = 2.5;       ///< Braking in an emergency, relative to the accelerations above.
    double corner_step = 0.05;           ///< [m/s] Change of the velocity vector that a corner may bring.
    double silence = 0.5;                ///< [s] Stands still at that age of the last path or pose.
    double position_tolerance = 0.03;    ///< [m] Of the robot at the last pose.
    double angle_tolerance = 0.05;       ///< [rad]
    double path_tolerance = 0.3;         ///< [m] A robot that is further from the path has left it.
    double delay = 0.2;                  ///< [s] From a command to the odometry that shows it, at most.
    double patience = 1.0;               ///< [s] At the end of the path, for a robot that does not come.
    double feedback = 1.0;  ///< [1/s] Of the velocity command, on the robot's distance from the pose command.
    Retreat::Options retreat;
  };
  /// Throws std::invalid_argument naming the bad option.
  explicit PathFollower(const Options& options);

  /// A path, or the same again (same `id`): then it only says that the path still holds. A new one is joined
  /// from where the robot is. @param T_WBs  Finite; empty = stop.
  void SetPath(Time id, std::vector<RigidTransform> T_WBs, Time now);
  /// Where the robot is. @param T_WB  Finite.
  void SetPose(const RigidTransform& T_WB, Time stamp);
  /// Whether the odometry says that it is lost; to be told again and again while it is.
  void SetLost(bool lost, Time stamp);

  /// Goes on to `now`; to be called often. A gap of more than 0.1 s counts as 0.1 s.
  Motion Step(Time now);

  const Options& options() const { return options_; }

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
  std::string Emergency(Time now);
  std::string TryJoin();
  void Advance(const std::string& emergency, double dt);
  void BrakeHard(double dt);
  void GoBack(double dt);
  void Drive(double dt);
  void Turn(double dt);
  void Travel(double next_speed, double dt);
  void Rotate(const Eigen::Vector3d& rate_B, double dt);
  void StandAtRobot();
  bool Standing() const;
  bool LeftPath() const;
  bool Blocked() const;
  bool CommandAtEnd() const;
  bool RobotAtEnd() const;
  void Judge(Time now);
  Motion Report() const;
  MotionCommand MakeCommand() const;

  double Lead() const;       ///< [m] From the robot to the command.
  double AngleLead() const;  ///< [rad]

  Options options_;
  double max_lead_;        ///< [m]
  double max_angle_lead_;  ///< [rad]

  std::optional<Path> path_;
  bool joined_ = false;  ///< track_ is on path_; else the way onto path_ is still to be found.
  std::optional<Pose> pose_;
  Time path_heard_;
  bool path_silent_ = false;  ///< Until it is heard again.
  bool pose_silent_ = false;
  std::optional<Time> last_step_;
  double dt_ = 0.0;  ///< [s] Of the last step.
  std::optional<Time> waiting_since_;

  // The command: on track_, where there is one.
  bool has_command_ = false;
  std::optional<Track> track_;
  double s_ = 0.0;      ///< [m]
  double speed_ = 0.0;  ///< [m/s]
  Eigen::Vector3d p_W_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_WB_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d rate_B_ = Eigen::Vector3d::Zero();  ///< [rad/s]

  Retreat retreat_;
  std::optional<Time> lost_;           ///< When it was last said.
  std::optional<MotionCommand> back_;  ///< While the robot goes back.

  MotionState state_ = MotionState::kIdle;
  std::string reason_;
};

}  // namespace thalweg::controller
