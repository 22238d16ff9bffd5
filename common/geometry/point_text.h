#pragma once

#include <Eigen/Core>
#include <string>

namespace thalweg {

/// Formats a point for people: "(1.00, 2.00, 1.20)".
std::string PointText(const Eigen::Vector3d& p);

}  // namespace thalweg
