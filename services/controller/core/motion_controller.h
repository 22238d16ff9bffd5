#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"
#include "common/voxel/occupancy_grid.h"
#include "services/controller/core/cut_off.h"

namespace thalweg::controller {

/// The pose at which the robot should be now, and the velocity at which it should move.
struct MotionCommand {
  RigidTransform T_WB;
  Eigen::Vector3d v_WB_B = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Vector3d w_WB_B = Eigen::Vector3d::Zero();  ///< [rad/s]

  /// The pose of the body in whose frame the velocities are: where the robot is, not where it is to be.
  RigidTransform T_WB_of_velocities = RigidTransform::Identity();

  /// The same velocities in the level frame with that body's heading, for a base that carries a gimbal: its
  /// turn is about z, the gimbal's about y, positive downward.
  MotionCommand Leveled() const;
};

enum class MotionState : std::uint8_t { kIdle, kFollowing, kDone, kStopped };

/// Why the robot does not move along its path, or what it waits for.
enum class StopReason : std::uint8_t {
  kNone,
  kNoPath,             ///< There has been none yet.
  kNoPose,             ///< Likewise.
  kNoMap,              ///< There is none yet to check the path with.
  kEmptyPath,          ///< The explorer stops the robot.
  kPathSilent,         ///< No path has been heard for a while.
  kGoingOn,            ///< Likewise; the robot follows the last one, which its own map allows.
  kGoingBack,          ///< Nor since; the robot goes back to Motion::back.
  kWentBack,           ///< It waits there.
  kPoseSilent,         ///< No pose has been heard for a while.
  kLost,               ///< The odometry is lost.
  kRetreating,         ///< Likewise; the robot goes back to the last known poses.
  kOffPath,            ///< The robot is too far from the path.
  kThroughSolid,       ///< The path leads through Motion::obstacle_W, which is known to be solid.
  kBlocked,            ///< The robot does not follow the command.
  kWaitingForArrival,  ///< The command is at the end of the path, the robot is not yet.
};

struct Motion {
  MotionState state = MotionState::kIdle;
  StopReason reason = StopReason::kNone;
  std::optional<BackPlace> back = {};              ///< Where the robot goes back to, or waits.
  std::optional<Eigen::Vector3d> obstacle_W = {};  ///< Center of the first solid voxel on the path.
  Time path_id = {};                               ///< The epoch when there is no path.
  double distance_done = 0.0;                      ///< [m] along the path since the robot joined it.
  double distance_left = 0.0;                      ///< [m]
  double speed = 0.0;                              ///< [m/s] commanded
  std::optional<MotionCommand> command = {};       ///< Empty until there has been a path and a pose.
};

/// A moment of a motion to come.
struct TrajectoryPoint {
  double time = 0.0;  ///< [s] from its beginning.
  RigidTransform T_WB;
  Eigen::Vector3d v_W = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Vector3d w_W = Eigen::Vector3d::Zero();  ///< [rad/s]
  Eigen::Vector3d a_W = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

/// Leads a robot along the paths of its explorer. To add one, see docs/guide/own-parts.md.
///
/// Whatever it is, it stops the robot when the path or the pose falls silent, when the odometry is lost, and
/// before what its map says is solid, if it is given one.
///
/// Threading: one thread.
class MotionController {
 public:
  virtual ~MotionController() = default;

  /// Sets the path. A path with the same `id` as before only confirms that the path is still valid; a new one
  /// is joined from where the robot is. @param T_WBs  Finite; empty = stop.
  virtual void SetPath(Time id, std::vector<RigidTransform> T_WBs, Time now) = 0;
  /// Sets the robot's pose. @param T_WB  Finite. @param stamp  One that is ahead of the clock counts as now.
  virtual void SetPose(const RigidTransform& T_WB, Time stamp) = 0;
  /// Sets whether the odometry reports that it is lost. Must be repeated while it is lost, because a report
  /// expires.
  virtual void SetLost(bool lost, Time stamp) = 0;
  /// Sets the map against which paths are checked. Must be called after each update of it.
  /// @param map  Must outlive the controller.
  virtual void SetMap(const OccupancyGrid& map, Time now) = 0;
  /// Sets whether the robot is to stay where it is, even if its explorer falls silent: the exploration has
  /// ended, or an operator has paused it.
  virtual void SetStays(bool stays) = 0;

  /// Advances to `now`; must be called often. A gap of more than 0.1 s counts as 0.1 s.
  virtual Motion Step(Time now) = 0;

  /// How the command moves from the last step on if the robot follows it and all that was heard last stays
  /// so: along the path, for `horizon` [s] at most, and to a stop. Ends at rest. @param step  [s] Between the
  /// points, > 0. @return Empty while there is no command; one point for a robot that is to stand.
  virtual std::vector<TrajectoryPoint> Preview(double step, double horizon) const = 0;
};

}  // namespace thalweg::controller
