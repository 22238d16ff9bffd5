#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "common/geometry/robot_model.h"
#include "services/simulator/core/world.h"

namespace thalweg::evaluator {

/// Measures how near a moving body came to the true surfaces, and how often it began to touch one.
class ContactMeter {
 public:
  static constexpr double kNone = 1e9;  ///< [m]

  /// @param world  Must outlive the meter.
  ContactMeter(const simulator::World& world, const RobotModel& robot) : world_(world), robot_(robot) {}

  /// @param p_W     True position of the body.
  /// @param travel  [m] Since the last call, of the body and, where parts move, of the fastest of these.
  void Move(const Eigen::Vector3d& p_W, double travel) {
    constexpr double kFarthest = 1.0;  // [m] Farther surfaces need not be found.
    clearance_ -= travel;              // a lower bound, which mostly spares the exact query
    if (clearance_ > 0.0 && clearance_ > least_clearance_) return;
    clearance_ = world_.ClearanceOf(robot_, p_W, kFarthest);
    least_clearance_ = std::min(least_clearance_, clearance_);
    if (clearance_ < 0.0 && !touching_) ++collisions_;
    touching_ = clearance_ < 0.0;
  }

  int collisions() const { return collisions_; }
  double least_clearance() const { return least_clearance_; }  ///< [m] kNone before the first call.

 private:
  const simulator::World& world_;
  RobotModel robot_;
  double clearance_ = 0.0;  ///< [m] Lower bound; exact when it matters.
  double least_clearance_ = kNone;
  int collisions_ = 0;
  bool touching_ = false;
};

}  // namespace thalweg::evaluator
