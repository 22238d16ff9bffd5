#include "services/explorer/core/way_home.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/check.h"

namespace thalweg::explorer {

void WayHome::Find(const PlanningMap& map) {
  THALWEG_CHECK(home_W_.has_value());
  search_.Flood(map, PathSearch::StartAt(map, *home_W_, options_.robot_radius, options_.exemption));
}

std::optional<double> WayHome::LengthFrom(const PlanningMap& map, const Eigen::Vector3d& p_W) const {
  double least = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(options_.exemption);
  const VoxelIndex low = map.IndexOf(p_W - reach);
  const VoxelIndex high = map.IndexOf(p_W + reach);
  VoxelIndex i;
  for (i.z = low.z; i.z <= high.z; ++i.z) {
    for (i.y = low.y; i.y <= high.y; ++i.y) {
      for (i.x = low.x; i.x <= high.x; ++i.x) {
        if (search_.Reached(i)) least = std::min(least, search_.Length(i) + (map.CenterOf(i) - p_W).norm());
      }
    }
  }
  return std::isfinite(least) ? std::optional(least) : std::nullopt;
}

Duration WayHome::TimeFor(double length) const {
  return FromSeconds(length / options_.max_speed + std::numbers::pi / options_.max_turn_rate);
}

}  // namespace thalweg::explorer
