#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "common/geometry/robot_model.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// The true robot. It moves straight toward the commanded pose within its speed limits. A robot that drives
/// stays level in the plane in which it starts: it uses only the horizontal position and the heading of a
/// command. One with a differential drive does not slide: it moves sideways at most by the share of its
/// forward motion by which a polyline differs from a curve. One that cannot turn on the spot drives forward
/// or back as far as the command lies ahead, and turns toward the command's heading, and by its offset to the
/// side, no tighter than it can [Hoffmann et al., Autonomous Automobile Trajectory Tracking for Off-Road
/// Driving, ACC 2007].
///
/// It never passes through a surface: it advances in steps no longer than its clearance [conservative
/// advancement, Mirtich 1996] and stops where it touches one, until a command leads away from it. A command
/// that is not renewed within its lifespan is dropped, and the robot stops.
class SimulatedRobot {
 public:
  static constexpr double kCommandLifespan = 0.5;  ///< [s]
  static constexpr double kContact = 1e-3;         ///< [m] The body touches any surface nearer than this.
  static constexpr double kClear = 0.01;           ///< [m] Contact has ended at this clearance.

  /// Keeps a reference to `world`. Throws std::invalid_argument when the robot does not fit at the start.
  SimulatedRobot(const World& world, const RobotModel& model, const RigidTransform& T_WB);

  void Command(const RigidTransform& T_WB);
  /// Advances simulated time by `dt` seconds.
  void Step(double dt);

  const RigidTransform& T_WB() const { return T_WB_; }
  const Eigen::Vector3d& v_WB_B() const { return v_WB_B_; }  ///< [m/s] Mean over the last step.
  const Eigen::Vector3d& w_WB_B() const { return w_WB_B_; }  ///< [rad/s] Mean over the last step.
  std::uint32_t collisions() const { return collisions_; }   ///< Number of contacts begun so far.
  /// [m] Distance from the body to the nearest surface, at most 10 m.
  double clearance() const;
  double least_clearance() const { return least_clearance_; }  ///< [m] Smallest clearance so far.
  double distance() const { return distance_; }                ///< [m] Length traveled.

 private:
  void Move(const Eigen::Vector3d& target_W, double reach);
  void Steer(double time);
  Eigen::Vector3d WithoutSliding(const Eigen::Vector3d& target_W) const;
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
