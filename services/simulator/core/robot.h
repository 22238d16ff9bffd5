#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "common/geometry/robot_model.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// The true robot: it moves towards the commanded pose, straight and within its speed limits. One that drives
/// keeps to the plane in which it starts, level: of a command it takes the place in that plane and the
/// heading.
///
/// It never passes through a surface: it moves by steps no longer than its clearance [conservative
/// advancement, Mirtich 1996] and stands where it meets one, until a command leads away from it.
/// A command that is not renewed within its lifespan is dropped, and the robot stands.
class SimulatedRobot {
 public:
  static constexpr double kCommandLifespan = 0.5;  ///< [s]
  static constexpr double kContact = 1e-3;         ///< [m] A surface nearer than this to the body is met.
  static constexpr double kClear = 0.01;           ///< [m] The contact has ended.

  /// Keeps the reference. Throws std::invalid_argument when the robot does not fit at the start.
  SimulatedRobot(const World& world, const RobotModel& model, const RigidTransform& T_WB);

  void Command(const RigidTransform& T_WB);
  /// Lets `dt` seconds pass.
  void Step(double dt);

  const RigidTransform& T_WB() const { return T_WB_; }
  const Eigen::Vector3d& v_WB_B() const { return v_WB_B_; }  ///< [m/s] Over the last step.
  const Eigen::Vector3d& w_WB_B() const { return w_WB_B_; }  ///< [rad/s] Over the last step.
  std::uint32_t collisions() const { return collisions_; }   ///< Contacts begun.
  /// [m] From the body to the nearest surface, up to 10 m.
  double clearance() const;
  double least_clearance() const { return least_clearance_; }  ///< [m] So far.
  double distance() const { return distance_; }                ///< [m] Travelled.

 private:
  void Move(const Eigen::Vector3d& target_W, double reach);
  double ClearanceAt(const Eigen::Vector3d& p_W) const;
  void NoteClearance(double clearance);

  const World& world_;
  RobotModel model_;
  RigidTransform T_WB_;
  std::optional<RigidTransform> command_;
  double command_age_ = 0.0;
  Eigen::Vector3d v_WB_B_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d w_WB_B_ = Eigen::Vector3d::Zero();
  bool touching_ = false;
  std::uint32_t collisions_ = 0;
  double least_clearance_ = std::numeric_limits<double>::infinity();
  double distance_ = 0.0;
};

}  // namespace thalweg::simulator
