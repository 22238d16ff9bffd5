#include "services/simulator/core/robot.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"
#include "common/geometry/attitude.h"
#include "services/simulator/core/reachable.h"

namespace thalweg::simulator {
namespace {

constexpr double kFarAway = 10.0;         // [m] greater clearances are not computed
constexpr double kClearanceError = 1e-6;  // [m] Embree's single precision at 10 m
// Sideways per forward motion: a polyline differs from the curve that it stands for by less.
constexpr double kSteering = 0.3;
constexpr double kSteerBack = 2.0;      // [rad/m] Per offset to the side.
constexpr double kMostSteerBack = 0.5;  // [rad]

}  // namespace

SimulatedRobot::SimulatedRobot(const World& world, const RobotModel& model, const RigidTransform& T_WB)
    : world_(world), model_(model), T_WB_(Held(model, T_WB)) {
  CheckStart(world, T_WB.translation(), model);
  NoteClearance(clearance());
}

void SimulatedRobot::Command(const RigidTransform& T_WB) {
  command_ = model_.drives ? InPlane(T_WB, T_WB_.translation().z()) : Held(model_, T_WB);
  command_age_ = 0.0;
}

void SimulatedRobot::Step(double dt) {
  THALWEG_CHECK(dt > 0.0);
  const RigidTransform before = T_WB_;
  const double active = std::clamp(kCommandLifespan - command_age_, 0.0, dt);
  command_age_ += dt;
  if (command_ && active > 0.0 && !model_.turns_on_the_spot()) {
    Steer(active);
  } else if (command_ && active > 0.0) {
    T_WB_ = TurnedFor(model_, T_WB_, *command_, active);
    const Eigen::Vector3d& to_W = command_->translation();
    Move(model_.faces_travel() ? WithoutSliding(to_W) : to_W, model_.max_speed * active);
  }
  if (!world_.parts().empty()) NoteClearance(clearance());  // a part may have come nearer, or left
  v_WB_B_ = T_WB_.linear().transpose() * (T_WB_.translation() - before.translation()) / dt;
  const Eigen::AngleAxisd turn(before.linear().transpose() * T_WB_.linear());
  w_WB_B_ = turn.axis() * turn.angle() / dt;
}

/// Drives toward the command, and turns by no more than the way allows.
void SimulatedRobot::Steer(double time) {
  const Eigen::Vector3d offset_B = T_WB_.inverse() * command_->translation();
  const Eigen::Vector3d before_W = T_WB_.translation();
  Move(T_WB_ * Eigen::Vector3d(offset_B.x(), 0.0, 0.0), model_.max_speed * time);
  const double driven = (T_WB_.translation() - before_W).norm();
  const double aside = std::clamp(kSteerBack * offset_B.y(), -kMostSteerBack, kMostSteerBack);
  const Eigen::Matrix3d wanted =
      command_->linear() * RotationFromYawPitch(std::copysign(aside, aside * offset_B.x()), 0.0);
  T_WB_ = TurnedTowards(T_WB_, MakeTransform(wanted, T_WB_.translation()),
                        std::min(driven / model_.min_turning_radius, model_.max_turn_rate * time));
}

/// The point nearest to the target that the robot comes to without turning.
Eigen::Vector3d SimulatedRobot::WithoutSliding(const Eigen::Vector3d& target_W) const {
  const Eigen::Vector3d offset_B = T_WB_.linear().transpose() * (target_W - T_WB_.translation());
  const double most = kSteering * std::abs(offset_B.x());
  return T_WB_ * Eigen::Vector3d(offset_B.x(), std::clamp(offset_B.y(), -most, most), 0.0);
}

void SimulatedRobot::Move(const Eigen::Vector3d& target_W, double reach) {
  const Eigen::Vector3d offset = target_W - T_WB_.translation();
  double left = std::min(offset.norm(), reach);
  if (left <= 0.0) return;
  const Eigen::Vector3d direction = offset.normalized();
  double clearance = ClearanceAt(T_WB_.translation());
  while (left > 0.0) {
    const bool near = clearance <= kContact;
    // In the open, a step shorter than the clearance meets no surface. In contact, short steps probe whether
    // the motion leads along the surface or away from it.
    const double step = std::min(left, near ? 0.5 * kContact : clearance - 0.5 * kContact);
    const Eigen::Vector3d next = T_WB_.translation() + step * direction;
    const double next_clearance = ClearanceAt(next);
    const bool nearer =
        next_clearance < clearance - kClearanceError || next_clearance < std::min(clearance, 0.0);
    if (near && nearer) {
      if (!touching_) ++collisions_;
      touching_ = true;
      return;
    }
    T_WB_.translation() = next;
    distance_ += step;
    left -= step;
    clearance = next_clearance;
    NoteClearance(clearance);
  }
}

double SimulatedRobot::ClearanceAt(const Eigen::Vector3d& p_W) const {
  return world_.ClearanceOf(model_, p_W, kFarAway);
}

void SimulatedRobot::NoteClearance(double clearance) {
  least_clearance_ = std::min(least_clearance_, clearance);
  if (clearance > kClear) touching_ = false;
}

double SimulatedRobot::clearance() const {
  return ClearanceAt(T_WB_.translation());
}

}  // namespace thalweg::simulator
