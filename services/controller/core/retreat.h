#pragma once

#include <deque>
#include <optional>

#include "common/geometry/rigid_transform.h"

namespace thalweg::controller {

/// Leads a lost robot back to where it last knew its pose. It retraces the newest part of the robot's own
/// path, pose by pose, so that the camera sees again what the odometry has seen before. That path was free a
/// moment ago; it is kept short because the robot moves along it without knowing its pose.
/// Threading: one thread.
class Retreat {
 public:
  struct Options {
    double reach = 0.5;          ///< [m] Longest retreat,
    double turn_reach = 1.2;     ///< [rad] and the most rotation in it.
    double max_speed = 0.25;     ///< [m/s]
    double max_turn_rate = 0.6;  ///< [rad/s]
  };
  explicit Retreat(const Options& options) : options_(options) {}

  /// Records a pose of the robot, or one commanded to it, while it is not lost.
  void Note(const RigidTransform& T_WB);
  /// The pose to move to from `T_WB` in the next `dt` seconds; nothing when no recorded pose is left.
  std::optional<RigidTransform> Back(const RigidTransform& T_WB, double dt);

 private:
  struct Step {
    RigidTransform T_WB;
    double travel = 0.0;  ///< [m] Distance from the previous pose.
    double turn = 0.0;    ///< [rad] Rotation from the previous pose.
  };
  Options options_;
  std::deque<Step> steps_;  ///< Newest last.
  double travel_ = 0.0;
  double turn_ = 0.0;
};

}  // namespace thalweg::controller
