#pragma once

#include <deque>
#include <optional>

#include "common/geometry/rigid_transform.h"

namespace thalweg::controller {

/// The way back to where the robot last knew its place, when it is lost: the newest part of its way, pose by
/// pose, so that its camera sees again what it saw. The way was free a moment ago, and it is short, since the
/// robot goes there without knowing where it is. Threading: one thread.
class Retreat {
 public:
  struct Options {
    double reach = 0.5;          ///< [m] Back, at most,
    double turn_reach = 1.2;     ///< [rad] and with no more turning than that.
    double max_speed = 0.25;     ///< [m/s]
    double max_turn_rate = 0.6;  ///< [rad/s]
  };
  explicit Retreat(const Options& options) : options_(options) {}

  /// The robot, not lost, is there or is sent there.
  void Note(const RigidTransform& T_WB);
  /// Where to go in the next `dt` seconds from `T_WB`. Nothing when there is no way left.
  std::optional<RigidTransform> Back(const RigidTransform& T_WB, double dt);

 private:
  struct Step {
    RigidTransform T_WB;
    double way = 0.0;   ///< [m] From the one before.
    double turn = 0.0;  ///< [rad]
  };
  Options options_;
  std::deque<Step> steps_;  ///< The newest last.
  double way_ = 0.0;
  double turn_ = 0.0;
};

}  // namespace thalweg::controller
