#include "services/explorer/core/way_home.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/check.h"

namespace thalweg::explorer {

void WayHome::Find(const PlanningMap& map) {
  THALWEG_CHECK(home_W_.has_value());
  for (const double exemption : {options_.exemption, options_.wide_exemption}) {
    exemption_ = exemption;
    search_.Flood(map, PathSearch::StartAt(map, *home_W_, options_.robot_radius, exemption));
    if (2 * search_.reached_count() >= map.traversable_count()) return;
  }
}

std::optional<double> WayHome::LengthFrom(const PlanningMap& map, const Eigen::Vector3d& p_W) const {
  double least = std::numeric_limits<double>::infinity();
  for (const PathSearch::Entry& entry : PathSearch::StartAt(map, p_W, options_.robot_radius, exemption_)) {
    if (!search_.Reached(entry.voxel)) continue;
    least = std::min(least, search_.Length(entry.voxel) + (map.CenterOf(entry.voxel) - p_W).norm());
  }
  return std::isfinite(least) ? std::optional(least) : std::nullopt;
}

Duration WayHome::TimeFor(double length) const {
  return FromSeconds(length / options_.max_speed + std::numbers::pi / options_.max_turn_rate);
}

}  // namespace thalweg::explorer
