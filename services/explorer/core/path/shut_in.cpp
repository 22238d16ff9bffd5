#include "services/explorer/core/path/shut_in.h"

#include <algorithm>
#include <cmath>

#include "common/voxel/for_each_voxel.h"
#include "common/voxel/voxels_within.h"

namespace thalweg::explorer {
namespace {

bool IsShutInWith(double clearance, const PlanningMap& map, const Eigen::Vector3d& p_W, double radius,
                  const PathSearch::Exemption& exemption) {
  const PlanningMap narrower = map.WithClearance(clearance);
  PathSearch search;
  const PathSearch::Start start = PathSearch::StartAt(narrower, p_W, std::min(radius, clearance), exemption);
  search.Flood(narrower, PathSearch::Parts(narrower, start).front());
  return IsShutIn(narrower, search);
}

/// Finds the clearance at the robot, and the side of the occupied voxel that limits it.
void MeasureHere(const PlanningMap& map, const Eigen::Vector3d& p_W, ShutIn& why) {
  why.here = why.needed;
  const double half_height = map.options().half_height;
  const double reach = std::max(why.needed, half_height);
  const Eigen::Vector3d extent = Eigen::Vector3d::Constant(reach);
  ForEachVoxel(VoxelsWithin({p_W - extent, p_W + extent}, map.voxel_size()), [&](const VoxelIndex& i) {
    if (map.State(i) != VoxelState::kOccupied) return;
    const Eigen::Vector3d offset = map.CenterOf(i) - p_W;
    const Eigen::Vector3d gap = (offset.cwiseAbs().array() - 0.5 * map.voxel_size()).cwiseMax(0.0);
    const double beside = gap.head<2>().norm();
    const double clearance =
        half_height > 0.0 ? std::max(beside, gap.z() - half_height + why.needed) : gap.norm();
    if (clearance >= why.here) return;
    why.here = std::max(clearance, 0.0);
    why.side = gap.z() <= beside  ? ShutIn::Side::kBeside
               : offset.z() < 0.0 ? ShutIn::Side::kBelow
                                  : ShutIn::Side::kAbove;
  });
}

}  // namespace

bool IsShutIn(const PlanningMap& map, const PathSearch& flooded) {
  return map.traversable_count() == 0 || flooded.reached_count() * 2 < map.traversable_count();
}

ShutIn WhyShutIn(const PlanningMap& map, const Eigen::Vector3d& p_W, double radius,
                 const PathSearch::Exemption& exemption) {
  ShutIn why{.radius = radius, .needed = map.options().clearance};
  MeasureHere(map, p_W, why);
  const double step = 0.5 * map.voxel_size();
  for (int n = static_cast<int>(std::ceil(why.needed / step)) - 1; n > 0 && !why.fitting; --n) {
    if (!IsShutInWith(n * step, map, p_W, radius, exemption)) why.fitting = n * step;
  }
  return why;
}

}  // namespace thalweg::explorer
