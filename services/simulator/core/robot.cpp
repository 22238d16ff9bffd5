#include "services/simulator/core/robot.h"

#include <algorithm>

#include "common/base/check.h"
#include "services/simulator/core/reachable.h"

namespace thalweg::simulator {
namespace {

constexpr double kFarAway = 10.0;           // [m] distances beyond are not told apart
constexpr double kDistanceRounding = 1e-6;  // [m] Embree's single precision at 10 m

}  // namespace

SimulatedRobot::SimulatedRobot(const World& world, const RobotModel& model, const RigidTransform& T_WB)
    : world_(world), model_(model), T_WB_(T_WB) {
  CheckStart(world, T_WB.translation(), model.radius);
  NoteDistance(DistanceAt(T_WB.translation()));
}

void SimulatedRobot::Command(const RigidTransform& T_WB) {
  command_ = T_WB;
  command_age_ = 0.0;
}

void SimulatedRobot::Step(double dt) {
  THALWEG_CHECK(dt > 0.0);
  const RigidTransform before = T_WB_;
  const double active = std::clamp(kCommandLifespan - command_age_, 0.0, dt);
  command_age_ += dt;
  if (command_ && active > 0.0) {
    const double angle = AngleBetween(T_WB_, *command_);
    const double share = angle > 0.0 ? std::min(1.0, model_.max_turn_rate * active / angle) : 1.0;
    T_WB_.linear() = Interpolate(T_WB_, *command_, share).linear();
    Move(command_->translation(), model_.max_speed * active);
  }
  v_WB_B_ = T_WB_.linear().transpose() * (T_WB_.translation() - before.translation()) / dt;
  const Eigen::AngleAxisd turn(before.linear().transpose() * T_WB_.linear());
  w_WB_B_ = turn.axis() * turn.angle() / dt;
}

void SimulatedRobot::Move(const Eigen::Vector3d& target_W, double reach) {
  const Eigen::Vector3d way = target_W - T_WB_.translation();
  double left = std::min(way.norm(), reach);
  if (left <= 0.0) return;
  const Eigen::Vector3d direction = way.normalized();
  double distance = DistanceAt(T_WB_.translation());
  while (left > 0.0) {
    const double clearance = distance - model_.radius;
    const bool near = clearance <= kContact;
    // In the open no surface is met within the clearance. Beside one, short steps feel the way along or away.
    const double step = std::min(left, near ? 0.5 * kContact : clearance - 0.5 * kContact);
    const Eigen::Vector3d next = T_WB_.translation() + step * direction;
    const double next_distance = DistanceAt(next);
    const bool nearer =
        next_distance < distance - kDistanceRounding || next_distance < std::min(distance, model_.radius);
    if (near && nearer) {
      if (!touching_) ++collisions_;
      touching_ = true;
      return;
    }
    T_WB_.translation() = next;
    distance_ += step;
    left -= step;
    distance = next_distance;
    NoteDistance(distance);
  }
}

double SimulatedRobot::DistanceAt(const Eigen::Vector3d& p_W) const {
  return world_.DistanceToSurface(p_W, kFarAway);
}

void SimulatedRobot::NoteDistance(double distance_to_surface) {
  const double clearance = distance_to_surface - model_.radius;
  least_clearance_ = std::min(least_clearance_, clearance);
  if (clearance > kClear) touching_ = false;
}

double SimulatedRobot::clearance() const {
  return DistanceAt(T_WB_.translation()) - model_.radius;
}

}  // namespace thalweg::simulator
