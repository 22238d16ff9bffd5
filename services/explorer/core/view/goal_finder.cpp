#include "services/explorer/core/view/goal_finder.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

std::vector<VoxelIndex> GoalFinder::GoalsOf(const Cluster& cluster, const PlanningMap& map,
                                            const PathSearch& search, const ViewPlanner& views) const {
  struct Place {
    std::uint64_t order;  // nearest to the robot first, then in grid order
    double distance;      // [m] to the unknown voxel
  };
  const DenseGrid<VoxelState>& states = map.states();
  const VoxelIndex reach{reach_, reach_, reach_};
  std::vector<Place> places;
  double nearest = std::numeric_limits<double>::infinity();
  for (const VoxelIndex& unknown : SpreadSample(cluster.unknowns, kSamples)) {
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
        const std::uint32_t cost = search.Cost(body);
        if (cost == PathSearch::kUnreached) continue;
        const Eigen::Vector3d eye_W = map.EyeAt(map.CenterOf(body));
        if (!views.CanShow(map.CenterOf(unknown) - eye_W)) continue;
        if (map.InSight(eye_W, map.CenterOf(unknown))) {
          places.push_back({std::uint64_t{cost} << 32U | states.Offset(body), distance});
          nearest = std::min(nearest, distance);
        }
        break;
      }
    }
  }
  std::vector<std::uint64_t> orders;
  for (const Place& place : places) {
    if (place.distance <= nearest + kDepth) orders.push_back(place.order);
  }
  std::ranges::sort(orders);
  orders.erase(std::unique(orders.begin(), orders.end()), orders.end());
  std::vector<VoxelIndex> goals;
  for (const std::uint64_t order : orders) goals.push_back(states.IndexAt(order & 0xFFFFFFFFU));
  return goals;
}

}  // namespace thalweg::explorer
