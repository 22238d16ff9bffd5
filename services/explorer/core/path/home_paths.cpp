#include "services/explorer/core/path/home_paths.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/check.h"

namespace thalweg::explorer {

void HomePaths::Find(const PlanningMap& map, const Eigen::Vector3d& robot_W) {
  THALWEG_CHECK(home_W_.has_value());
  for (const PathSearch::Exemption& exemption :
       {PathSearch::Exemption{options_.exemption}, PathSearch::Exemption{options_.wide_exemption, true}}) {
    exemption_ = exemption;
    search_.Flood(map, PathSearch::StartAt(map, *home_W_, options_.robot_radius, exemption));
    if (2 * search_.reached_count() >= map.traversable_count() && ExitFrom(map, robot_W)) return;
  }
}

std::optional<HomePaths::Exit> HomePaths::ExitFrom(const PlanningMap& map, const Eigen::Vector3d& p_W) const {
  std::optional<Exit> best;
  for (const PathSearch::Exemption& exemption : {PathSearch::Exemption{options_.exemption}, exemption_}) {
    for (const PathSearch::Entry& entry : PathSearch::StartAt(map, p_W, options_.robot_radius, exemption)) {
      if (!search_.Reached(entry.voxel)) continue;
      const double length = search_.Length(entry.voxel) + (map.CenterOf(entry.voxel) - p_W).norm();
      if (!best || length < best->length) best = Exit{entry.voxel, length};
    }
    if (best || !exemption_.from_pocket) break;  // the other exemption is the same
  }
  return best;
}

std::optional<double> HomePaths::LengthFrom(const PlanningMap& map, const Eigen::Vector3d& p_W) const {
  const std::optional<Exit> exit = ExitFrom(map, p_W);
  return exit ? std::optional(exit->length) : std::nullopt;
}

std::vector<Eigen::Vector3d> HomePaths::PathFrom(const PlanningMap& map, const Eigen::Vector3d& p_W) const {
  const std::optional<Exit> exit = ExitFrom(map, p_W);
  if (!exit) return {};
  std::vector<Eigen::Vector3d> path_W = search_.PathFrom(map, *home_W_, exit->voxel);
  path_W.push_back(p_W);
  std::ranges::reverse(path_W);
  return path_W;
}

Duration HomePaths::TimeFor(double length) const {
  return FromSeconds(length / options_.max_speed + std::numbers::pi / options_.max_turn_rate);
}

}  // namespace thalweg::explorer
