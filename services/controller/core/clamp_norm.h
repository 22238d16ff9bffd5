#pragma once

#include <Eigen/Core>

namespace thalweg::controller {

/// The vector, shortened to `longest` if it is longer.
inline Eigen::Vector3d ClampNorm(const Eigen::Vector3d& v, double longest) {
  const double norm = v.norm();
  return norm > longest ? Eigen::Vector3d(v * (longest / norm)) : v;
}

}  // namespace thalweg::controller
