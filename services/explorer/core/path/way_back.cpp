#include "services/explorer/core/path/way_back.h"

#include <cmath>

#include "services/explorer/core/path/path_comfort.h"

namespace thalweg::explorer {
namespace {

constexpr double kStep = 0.5;          // [voxels] Between places that are examined.
constexpr double kOffTheTrack = 2.0;   // [voxels] The way leads at most so far beside that by which it came,
constexpr double kOffTheWalls = 1.0;   // [voxels] and is wider by this, where it can be.
constexpr double kJustTouches = 1e-6;  // [m]

/// The way by which the robot came, back to the center of the first voxel from which it can go on; empty if
/// there is none.
std::vector<Eigen::Vector3d> TrackBack(const PlanningMap& map, const Eigen::Vector3d& p_W,
                                       std::span<const RigidTransform> came,
                                       const std::function<bool(const VoxelIndex&)>& leads_on) {
  std::vector<Eigen::Vector3d> track_W = {p_W};
  for (const RigidTransform& T_WB : came) {
    Eigen::Vector3d to_W = T_WB.translation();
    if (map.plane()) to_W.z() = *map.plane();
    const Eigen::Vector3d from_W = track_W.back();
    const int steps = static_cast<int>(std::ceil((to_W - from_W).norm() / (kStep * map.voxel_size())));
    for (int n = 1; n <= steps; ++n) {
      track_W.push_back(from_W + (to_W - from_W) * n / steps);
      const VoxelIndex here = map.IndexOf(track_W.back());
      if (!map.Traversable(here) || !leads_on(here)) continue;
      track_W.push_back(map.CenterOf(here));
      return track_W;
    }
  }
  return {};
}

}  // namespace

std::vector<Eigen::Vector3d> WayBack(const PlanningMap& map, const Eigen::Vector3d& p_W,
                                     std::span<const RigidTransform> came, double radius,
                                     const std::function<bool(const VoxelIndex&)>& leads_on) {
  const std::vector<Eigen::Vector3d> track_W = TrackBack(map, p_W, came, leads_on);
  if (track_W.empty()) return {};
  std::vector<Eigen::Vector3d> path_W =
      FindWiderPath(map, track_W, radius,
                    {.distance = kOffTheWalls * map.voxel_size(), .reach = kOffTheTrack * map.voxel_size()});
  // Where the robot stands too near to something, the path begins as the track does, whatever is in its way.
  for (std::size_t n = 1; n < path_W.size(); ++n) {
    if (!map.ClearToLeave(path_W[n - 1], path_W[n], PlanningMap::Obstacles::kOccupied, radius - kJustTouches))
      return {};
  }
  return path_W;
}

}  // namespace thalweg::explorer
