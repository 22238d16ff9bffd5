#include "services/explorer/core/goal_finder.h"

#include <algorithm>
#include <limits>

namespace thalweg::explorer {
namespace {

constexpr std::size_t kSamples = 8;  ///< Of a cluster's unknowns.
constexpr std::size_t kRays = 200;
constexpr double kDepth = 0.3;  ///< [m] Goals may be so much further from the cluster than the nearest one.

std::vector<VoxelIndex> SpreadSample(const std::vector<VoxelIndex>& voxels) {
  if (voxels.size() <= kSamples) return voxels;
  std::vector<VoxelIndex> sample;
  for (std::size_t n = 0; n < kSamples; ++n) sample.push_back(voxels[n * voxels.size() / kSamples]);
  return sample;
}

}  // namespace

GoalFinder::GoalFinder(double look_range, double voxel_size)
    : rays_(SpreadRays(kRays, look_range, voxel_size)) {}

std::vector<VoxelIndex> GoalFinder::GoalsOf(const Cluster& cluster, const PlanningMap& map,
                                            const PathSearch& search, const ViewPlanner& views) const {
  struct Place {
    VoxelIndex voxel;
    double distance;  // [m] to the unknown
  };
  std::vector<Place> places;
  double nearest = std::numeric_limits<double>::infinity();
  for (const VoxelIndex& unknown : SpreadSample(cluster.unknowns)) {
    for (const std::vector<RayStep>& ray : rays_) {
      for (const auto& [offset, distance] : ray) {
        const VoxelIndex i = unknown + offset;
        if (distance > nearest + kDepth || map.State(i) != VoxelState::kFree) break;
        const VoxelIndex body = map.BodyOf(i);
        if (!search.Reached(body)) continue;
        const Eigen::Vector3d eye_W = map.EyeAt(map.CenterOf(body));
        if (!views.CanShow(map.CenterOf(unknown) - eye_W)) continue;
        if (map.InSight(eye_W, map.CenterOf(unknown))) {
          places.push_back({body, distance});
          nearest = std::min(nearest, distance);
        }
        break;
      }
    }
  }
  std::erase_if(places, [&](const Place& place) { return place.distance > nearest + kDepth; });
  std::sort(places.begin(), places.end(), [&](const Place& a, const Place& b) {
    const std::uint32_t cost_a = search.Cost(a.voxel);
    const std::uint32_t cost_b = search.Cost(b.voxel);
    if (cost_a != cost_b) return cost_a < cost_b;
    return map.states().Offset(a.voxel) < map.states().Offset(b.voxel);
  });
  std::vector<VoxelIndex> goals;
  for (const Place& place : places) {
    if (goals.empty() || !(goals.back() == place.voxel)) goals.push_back(place.voxel);
  }
  return goals;
}

}  // namespace thalweg::explorer
