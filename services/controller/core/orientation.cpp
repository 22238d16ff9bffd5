#include "services/controller/core/orientation.h"

#include <algorithm>
#include <cmath>

#include "services/controller/core/clamp_norm.h"

namespace thalweg::controller {
namespace {

Eigen::Quaterniond RotationBy(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  if (angle < 1e-12) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation / angle));
}

}  // namespace

void Orientation::Place(const Eigen::Quaterniond& q_WB) {
  q_WB_ = q_WB;
  at_ = YawPitchOf(q_WB.toRotationMatrix());
  Stop();
}

/// The rotation of this step, rate * dt, plus the braking after it, rate^2 / 2a - rate dt / 2, must fit in
/// the angle.
double Orientation::RateFor(double angle, double greatest, double dt) const {
  const double half = 0.5 * limits_.acceleration * dt;
  return std::min({greatest, std::sqrt(half * half + 2.0 * limits_.acceleration * angle) - half, angle / dt});
}

void Orientation::TurnTo(const Eigen::Quaterniond& wanted, double most, double dt) {
  const double change = limits_.acceleration * dt;
  if (!has_gimbal()) {
    const Eigen::AngleAxisd turn(q_WB_.conjugate() * wanted);
    const Eigen::Vector3d error_B = turn.angle() * turn.axis();
    const double angle = error_B.norm();
    const double rate = RateFor(angle, std::min(most, limits_.rate), dt);
    Eigen::Vector3d wanted_B = Eigen::Vector3d::Zero();
    if (angle > 0.0) wanted_B = error_B * (rate / angle);
    Turn(rate_B_ + ClampNorm(wanted_B - rate_B_, change), dt);
    return;
  }
  const YawPitch to = YawPitchOf(wanted.toRotationMatrix());
  const Eigen::Array2d error(WrappedAngle(to.yaw - at_.yaw), to.pitch - at_.pitch);
  const Eigen::Array2d greatest(std::min(most, limits_.rate), std::min(most, limits_.gimbal_rate));
  Eigen::Vector2d rates;
  for (int n = 0; n < 2; ++n) {
    const double wanted_rate = std::copysign(RateFor(std::abs(error[n]), greatest[n], dt), error[n]);
    rates[n] = rates_[n] + std::clamp(wanted_rate - rates_[n], -change, change);
  }
  TurnGimbal(rates, dt);
}

void Orientation::TurnWith(const Eigen::Quaterniond& wanted, double dt) {
  const Eigen::AngleAxisd turn(q_WB_.conjugate() * wanted);
  Place(wanted);
  rate_B_ = turn.angle() / dt * turn.axis();
}

void Orientation::Brake(double harder, double dt) {
  const double change = harder * limits_.acceleration * dt;
  if (!has_gimbal()) return Turn(rate_B_ - ClampNorm(rate_B_, change), dt);
  TurnGimbal(rates_ - rates_.cwiseMin(change).cwiseMax(-change), dt);
}

void Orientation::Turn(const Eigen::Vector3d& rate_B, double dt) {
  rate_B_ = rate_B;
  q_WB_ = (q_WB_ * RotationBy(rate_B * dt)).normalized();
}

void Orientation::TurnGimbal(const Eigen::Vector2d& rates, double dt) {
  rates_ = rates;
  at_ = {WrappedAngle(at_.yaw + rates[0] * dt), at_.pitch + rates[1] * dt};
  const Eigen::Matrix3d R_WB = RotationFromYawPitch(at_.yaw, at_.pitch);
  q_WB_ = Eigen::Quaterniond(R_WB);
  rate_B_ = R_WB.transpose() * Eigen::Vector3d(0.0, 0.0, rates[0]) - Eigen::Vector3d(0.0, rates[1], 0.0);
}

}  // namespace thalweg::controller
