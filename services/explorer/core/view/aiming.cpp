#include "services/explorer/core/view/aiming.h"

#include <algorithm>

#include "common/geometry/polyline.h"

namespace thalweg::explorer {
namespace {

constexpr double kPathSampling = 0.2;  // [m]

}  // namespace

void StopWhereSeen(const PlanningMap& map, const ViewPlanner& views, double look_range,
                   const std::vector<VoxelIndex>& target, std::vector<Eigen::Vector3d>& path_W) {
  const auto sees = [&](const Eigen::Vector3d& p_W, const VoxelIndex& i) {
    return views.CanSee(map, map.EyeAt(p_W), map.CenterOf(i), look_range);
  };
  std::vector<VoxelIndex> seen_at_goal;
  for (const VoxelIndex& i : target) {
    if (sees(path_W.back(), i)) seen_at_goal.push_back(i);
  }
  if (seen_at_goal.empty()) return;
  const auto is_enough = [&](const Eigen::Vector3d& p_W) {
    const auto seen = std::count_if(seen_at_goal.begin(), seen_at_goal.end(),
                                    [&](const VoxelIndex& i) { return sees(p_W, i); });
    return 2 * static_cast<std::size_t>(seen) >= seen_at_goal.size();
  };
  if (path_W.size() > 1 && is_enough(path_W.front())) {
    path_W = {path_W.front(), path_W.front()};
    return;
  }
  for (std::size_t n = 1; n < path_W.size(); ++n) {
    Eigen::Vector3d end_W;
    const bool goes_on =
        ForEachPointAlong(path_W[n - 1], path_W[n], kPathSampling, [&](const Eigen::Vector3d& p_W) {
          end_W = p_W;
          return !is_enough(p_W);
        });
    if (goes_on) continue;
    path_W.resize(n);
    path_W.push_back(end_W);
    return;
  }
}

View BestViewOf(const std::vector<VoxelIndex>& target, const std::vector<Sighting>& sightings,
                const DenseGrid<std::uint8_t>& set_aside, const ViewPlanner& views,
                const Eigen::Matrix3d& R_WB) {
  std::vector<bool> counts(sightings.size());
  std::vector<bool> required(sightings.size());
  for (std::size_t n = 0; n < sightings.size(); ++n) {
    counts[n] = set_aside[sightings[n].voxel] == 0;
    required[n] = std::find(target.begin(), target.end(), sightings[n].voxel) != target.end();
  }
  return views.Best(sightings, counts, required, R_WB);
}

}  // namespace thalweg::explorer
