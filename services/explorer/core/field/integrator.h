#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

namespace thalweg::explorer {

/// How a line p' = f(p) is followed; of order 1, 2 and 4.
enum class Integrator : std::uint8_t { kEuler, kImprovedEuler, kRungeKutta4 };

/// The point one step of length h further [Shade: Choosing Where To Go, DPhil thesis, Oxford 2011, Ch. 6];
/// empty where f is empty.
/// @param f  Eigen::Vector3d -> std::optional<Eigen::Vector3d>
template <class Field>
std::optional<Eigen::Vector3d> StepAlong(Integrator integrator, const Field& f, const Eigen::Vector3d& p,
                                         double h) {
  using Vector = std::optional<Eigen::Vector3d>;
  const Vector k1 = f(p);
  if (!k1) return std::nullopt;
  if (integrator == Integrator::kEuler) return p + h * *k1;
  if (integrator == Integrator::kImprovedEuler) {
    const Vector k2 = f(p + h * *k1);
    if (!k2) return std::nullopt;
    return p + 0.5 * h * (*k1 + *k2);
  }
  const Vector k2 = f(p + 0.5 * h * *k1);
  const Vector k3 = k2 ? f(p + 0.5 * h * *k2) : std::nullopt;
  const Vector k4 = k3 ? f(p + h * *k3) : std::nullopt;
  if (!k4) return std::nullopt;
  return p + h / 6.0 * (*k1 + 2.0 * *k2 + 2.0 * *k3 + *k4);
}

}  // namespace thalweg::explorer
