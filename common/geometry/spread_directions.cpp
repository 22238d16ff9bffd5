#include "common/geometry/spread_directions.h"

#include <cmath>
#include <numbers>

namespace thalweg {

std::vector<Eigen::Vector3d> SpreadDirections(std::size_t count) {
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));  // [rad]
  std::vector<Eigen::Vector3d> directions;
  directions.reserve(count);
  for (std::size_t n = 0; n < count; ++n) {
    const double z = 1.0 - (2.0 * static_cast<double>(n) + 1.0) / static_cast<double>(count);
    const double angle = golden * static_cast<double>(n);
    const double radius = std::sqrt(1.0 - z * z);
    directions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return directions;
}

}  // namespace thalweg
