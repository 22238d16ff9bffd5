#include "common/voxel/map_agreement.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "common/voxel/for_each_voxel.h"
#include "common/voxel/ray.h"

namespace thalweg {
namespace {

bool IsNear(const VoxelIndex& a, const VoxelIndex& b, int reach) {
  const VoxelIndex step = a - b;
  return std::max({std::abs(step.x), std::abs(step.y), std::abs(step.z)}) <= reach;
}

/// What the surroundings of a measured point say.
RayVerdict VerdictAt(const OccupancyGrid& grid, const VoxelIndex& end, int reach) {
  bool all_free = true;
  const bool no_surface = ForEachVoxel(CubeAround(end, reach), [&](const VoxelIndex& voxel) {
    const VoxelState state = grid.State(voxel);
    all_free = all_free && state == VoxelState::kFree;
    return state != VoxelState::kOccupied;
  });
  if (!no_surface) return RayVerdict::kAgrees;
  return all_free ? RayVerdict::kContradicts : RayVerdict::kUnknown;
}

/// @param reach  Voxels before the end that do not count, since a surface is measured there; -1 = none is.
bool PassesThroughASurface(const OccupancyGrid& grid, const Eigen::Vector3d& from_W,
                           const Eigen::Vector3d& end_W, int reach) {
  const VoxelIndex end = grid.IndexOf(end_W);
  VoxelState last = VoxelState::kUnknown;
  bool passes = false;
  TraverseVoxels(from_W, end_W, grid.voxel_size(), [&](const VoxelIndex& voxel) {
    if (IsNear(voxel, end, reach)) return false;
    const VoxelState state = grid.State(voxel);
    passes = last == VoxelState::kOccupied && state == VoxelState::kUnknown;
    last = state;
    return !passes;
  });
  return passes;
}

}  // namespace

std::string AnotherPlaceText(const MapAgreement& agreement, const std::string& file) {
  return file + " is of another place, or of a robot that started elsewhere: it contradicts " +
         std::to_string(agreement.contradicting) + " of the " + std::to_string(agreement.known()) +
         " rays that it knows something about: choose another --out or remove the file";
}

MapAgreement JudgeRays(
    const PointCloud& cloud, const RigidTransform& T_WC, double max_range, double farthest,
    const std::function<RayVerdict(const Eigen::Vector3d& from_W, const Eigen::Vector3d& end_W,
                                   bool ends_in_range)>& verdict) {
  constexpr std::size_t kMostRays = 2000;
  const std::size_t stride = cloud.points_C.size() / kMostRays + 1;
  const Eigen::Vector3d from_W = T_WC.translation();
  MapAgreement agreement;
  if (!(from_W.cwiseAbs().maxCoeff() < farthest)) return agreement;
  for (std::size_t k = 0; k < cloud.points_C.size(); k += stride) {
    const Eigen::Vector3d p_C = cloud.points_C[k].cast<double>();
    const double range = p_C.norm();
    if (!std::isfinite(range)) continue;  // not measured
    const bool ends_in_range = range <= max_range;
    const Eigen::Vector3d end_W = T_WC * (ends_in_range ? p_C : Eigen::Vector3d(p_C * (max_range / range)));
    if (!(end_W.cwiseAbs().maxCoeff() < farthest)) continue;
    const RayVerdict its = verdict(from_W, end_W, ends_in_range);
    agreement.agreeing += its == RayVerdict::kAgrees ? 1 : 0;
    agreement.contradicting += its == RayVerdict::kContradicts ? 1 : 0;
  }
  return agreement;
}

MapAgreement Compare(const OccupancyGrid& grid, const PointCloud& cloud, const RigidTransform& T_WC,
                     double max_range) {
  constexpr double kTolerance = 0.25;  // [m]
  constexpr int kMostReach = 5;
  const int reach = std::clamp(static_cast<int>(std::ceil(kTolerance / grid.voxel_size())), 1, kMostReach);
  const double farthest = grid.voxel_size() * (kMaxVoxelIndex - kMostReach);
  return JudgeRays(cloud, T_WC, max_range, farthest,
                   [&](const Eigen::Vector3d& from_W, const Eigen::Vector3d& end_W, bool ends_in_range) {
                     if (PassesThroughASurface(grid, from_W, end_W, ends_in_range ? reach : -1))
                       return RayVerdict::kContradicts;
                     return ends_in_range ? VerdictAt(grid, grid.IndexOf(end_W), reach)
                                          : RayVerdict::kUnknown;
                   });
}

}  // namespace thalweg
