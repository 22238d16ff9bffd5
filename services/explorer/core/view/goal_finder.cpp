#include "services/explorer/core/view/goal_finder.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "common/voxel/for_each_voxel.h"

namespace thalweg::explorer {
namespace {

constexpr std::size_t kSamples = 8;  ///< Drawn from a cluster's unknowns.
constexpr std::size_t kRays = 200;
/// [m] Goals may be farther from the cluster than the nearest one by this much.
constexpr double kDepth = 0.3;

}  // namespace

GoalFinder::GoalFinder(double look_range, double voxel_size)
    : rays_(SpreadRays(kRays, look_range, voxel_size)),
      reach_(static_cast<int>(std::ceil(look_range / voxel_size)) + 1) {}

std::vector<VoxelIndex> GoalFinder::SampleOf(const Cluster& cluster) {
  return SpreadSample(cluster.unknowns, kSamples);
}

GoalFinder::Places GoalFinder::PlacesOf(const std::vector<VoxelIndex>& sample, const PlanningMap& map,
                                        const PathSearch& search, const ViewPlanner& views) const {
  struct Place {
    std::size_t offset;
    double distance;  // [m] to the unknown voxel
  };
  const DenseGrid<VoxelState>& states = map.states();
  const VoxelIndex reach{reach_, reach_, reach_};
  std::vector<Place> found;
  double nearest = std::numeric_limits<double>::infinity();
  for (const VoxelIndex& unknown : sample) {
    // Far from the box's faces voxels are found by offsets alone.
    const bool inside = states.Contains(unknown - reach) && states.Contains(unknown + reach);
    const VoxelState* const here = inside ? states.data() + states.Offset(unknown) : nullptr;
    const auto state_at = [&](const VoxelIndex& offset) {
      if (!inside) return map.State(unknown + offset);
      return here[offset.x + offset.y * states.stride_y() + offset.z * states.stride_z()];
    };
    for (const std::vector<RayStep>& ray : rays_) {
      for (const auto& [offset, distance] : ray) {
        if (distance > nearest + kDepth || state_at(offset) != VoxelState::kFree) break;
        const VoxelIndex body = map.BodyOf(unknown + offset);
        if (!search.Reached(body)) continue;
        const Eigen::Vector3d eye_W = map.EyeAt(map.CenterOf(body));
        if (!views.CanShow(map.CenterOf(unknown) - eye_W)) continue;
        if (map.InSight(eye_W, map.CenterOf(unknown))) {
          found.push_back({states.Offset(body), distance});
          nearest = std::min(nearest, distance);
        }
        break;
      }
    }
  }
  // Rays that went on farther than this, before the nearest place was found, have given nothing.
  const double farthest = (nearest + kDepth) / map.voxel_size();  // [voxels]
  const int around = std::min(reach_, std::isinf(farthest) ? reach_ : static_cast<int>(farthest) + 1) +
                     std::abs(map.BodyOf({0, 0, 0}).z);
  Places places{.voxels = {}, .depends_on = CubeAround(sample.front(), around)};
  for (const VoxelIndex& unknown : sample) {
    const VoxelBox its = CubeAround(unknown, around);
    VoxelBox& all = places.depends_on;
    all.min = {std::min(all.min.x, its.min.x), std::min(all.min.y, its.min.y),
               std::min(all.min.z, its.min.z)};
    all.max = {std::max(all.max.x, its.max.x), std::max(all.max.y, its.max.y),
               std::max(all.max.z, its.max.z)};
  }
  std::vector<std::size_t> offsets;
  for (const Place& place : found) {
    if (place.distance <= nearest + kDepth) offsets.push_back(place.offset);
  }
  std::ranges::sort(offsets);
  offsets.erase(std::unique(offsets.begin(), offsets.end()), offsets.end());
  for (const std::size_t offset : offsets) places.voxels.push_back(states.IndexAt(offset));
  return places;
}

std::vector<VoxelIndex> GoalFinder::NearestFirst(const Places& places, const PathSearch& search) {
  const auto cost = [&](const VoxelIndex& i) { return search.Cost(i); };
  std::vector<VoxelIndex> goals = places.voxels;
  std::ranges::stable_sort(goals, {}, cost);  // in grid order where costs are equal
  return goals;
}

}  // namespace thalweg::explorer
