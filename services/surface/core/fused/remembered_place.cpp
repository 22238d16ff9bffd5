#include "services/surface/core/fused/remembered_place.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "common/voxel/for_each_voxel.h"
#include "common/voxel/ray.h"

namespace thalweg::surface {
namespace {

constexpr double kCube = 0.06;       // [m] Least edge of a cube.
constexpr double kTolerance = 0.25;  // [m] as after a drift of the odometry
constexpr float kBehind = 1.0F;      // [voxels] An edge that a ray grazes is less thick.

/// An edge of a cube is 2 to the power of so many voxels: few enough cubes make the tolerance.
int CubeBits(double voxel_size) {
  int bits = 0;
  while (voxel_size * (1 << bits) < kCube) ++bits;
  return bits;
}

}  // namespace

RememberedPlace::RememberedPlace(const TruncatedVolume& volume)
    : cube_bits_(CubeBits(volume.voxel_size())),
      depths_(volume.voxel_size()),
      cubes_(volume.voxel_size() * (1 << cube_bits_)) {
  const auto voxel_size = static_cast<float>(volume.voxel_size());
  volume.ForEachBlock([&](const VoxelIndex& index, const TruncatedVolume::Block& block) {
    constexpr int kEdge = TruncatedVolume::kEdge;
    VoxelIndex i;
    for (i.z = 0; i.z < kEdge; ++i.z) {
      for (i.y = 0; i.y < kEdge; ++i.y) {
        for (i.x = 0; i.x < kEdge; ++i.x) {
          const SurfaceVoxel& its = block.voxels[TruncatedVolume::OffsetOf(i.x, i.y, i.z)];
          const VoxelIndex voxel{index.x * kEdge + i.x, index.y * kEdge + i.y, index.z * kEdge + i.z};
          if (!its.known() || !InIndexRange(voxel)) continue;
          const float depth = -its.distance / voxel_size;
          depths_.Set(voxel, depth);
          if (std::abs(depth) <= kBehind)
            cubes_.Set({voxel.x >> cube_bits_, voxel.y >> cube_bits_, voxel.z >> cube_bits_}, 1.0F);
        }
      }
    }
  });
}

bool RememberedPlace::EndsAtSurface(const Eigen::Vector3d& end_W) const {
  const int reach = std::max(1, static_cast<int>(std::ceil(kTolerance / cubes_.voxel_size())));
  return !ForEachVoxel(CubeAround(cubes_.IndexOf(end_W), reach),
                       [&](const VoxelIndex& cube) { return cubes_.State(cube) != VoxelState::kOccupied; });
}

bool RememberedPlace::GoesThroughSurface(const Eigen::Vector3d& from_W, const Eigen::Vector3d& end_W) const {
  bool was_before = false;
  bool goes_through = false;
  TraverseVoxels(from_W, end_W, depths_.voxel_size(), [&](const VoxelIndex& voxel) {
    const float depth = depths_.LogOdds(voxel);  // NaN = unknown
    goes_through = was_before && depth >= kBehind;
    was_before = depth < 0.0F || (was_before && depth < kBehind);
    return !goes_through;
  });
  return goes_through;
}

MapAgreement RememberedPlace::Compare(const PointCloud& cloud, const RigidTransform& T_WC,
                                      double max_range) const {
  const double farthest = depths_.voxel_size() * kMaxVoxelIndex - kTolerance;
  return JudgeRays(cloud, T_WC, max_range, farthest,
                   [&](const Eigen::Vector3d& from_W, const Eigen::Vector3d& end_W, bool ends_in_range) {
                     const Eigen::Vector3d ray_W = end_W - from_W;
                     const double length = ray_W.norm();
                     const double followed = ends_in_range ? length - kTolerance : length;
                     if (!(length > 0.0)) return RayVerdict::kUnknown;
                     if (followed > 0.0 && GoesThroughSurface(from_W, from_W + ray_W * (followed / length)))
                       return RayVerdict::kContradicts;
                     return ends_in_range && EndsAtSurface(end_W) ? RayVerdict::kAgrees
                                                                  : RayVerdict::kUnknown;
                   });
}

}  // namespace thalweg::surface
