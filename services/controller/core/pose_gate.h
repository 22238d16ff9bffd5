#pragma once

#include <optional>

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"
#include "common/geometry/robot_model.h"

namespace thalweg::controller {

/// Refuses poses that the robot cannot have reached: its odometry errs, or somebody invents it. If the poses
/// stay where they have jumped to, the odometry has corrected itself, and they are believed after a while,
/// during which the robot stands because its pose is silent.
///
/// Threading: one thread.
class PoseGate {
 public:
  struct Options {
    double max_speed = RobotModel{}.max_speed;          ///< [m/s] The robot's greatest speed.
    double max_turn_rate = RobotModel{}.max_turn_rate;  ///< [rad/s]
    /// Faster than the robot's limits by this factor is a jump: a robot overshoots, and odometry jitters.
    double factor = 3.0;
    double slack = 0.1;        ///< [m] In addition, whatever the time between two poses.
    double turn_slack = 0.3;   ///< [rad]
    double persistence = 1.0;  ///< [s] Time after which poses at another place are believed.
  };
  explicit PoseGate(const Options& options) : options_(options) {}

  /// From the last good pose to one that is refused.
  struct Jump {
    double distance;  ///< [m]
    double turn;      ///< [rad]
    double time;      ///< [s] Between the two stamps.
  };
  /// @return How far the pose jumps if it is refused; nothing if it is good.
  std::optional<Jump> Refuse(const RigidTransform& T_WB, Time stamp);

 private:
  struct Pose {
    RigidTransform T_WB;
    Time stamp;
  };
  bool CanFollow(const Pose& from, const Pose& to) const;

  Options options_;
  std::optional<Pose> last_;       ///< The last good one.
  std::optional<Pose> elsewhere_;  ///< The last refused one,
  std::optional<Time> jumped_at_;  ///< and when the first of those was heard that led to it without a jump.
};

}  // namespace thalweg::controller
