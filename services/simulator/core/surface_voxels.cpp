#include "services/simulator/core/surface_voxels.h"

#include "services/simulator/core/triangle.h"

namespace thalweg::simulator {
namespace {

/// The voxels of `box` that intersect a triangle's bounding box grown by `margin`.
VoxelBox VoxelsAround(const Triangle& triangle, const VoxelBox& box, double voxel_size, double margin) {
  Eigen::AlignedBox3d extent;
  for (const Eigen::Vector3d& corner : triangle) extent.extend(corner);
  const Eigen::Vector3d grow = Eigen::Vector3d::Constant(margin);
  const VoxelIndex low = VoxelAt(extent.min() - grow, voxel_size);
  const VoxelIndex high = VoxelAt(extent.max() + grow, voxel_size);
  return {
      {std::max(low.x, box.min.x), std::max(low.y, box.min.y), std::max(low.z, box.min.z)},
      {std::min(high.x + 1, box.max.x), std::min(high.y + 1, box.max.y), std::min(high.z + 1, box.max.z)}};
}

}  // namespace

SurfaceVoxels::SurfaceVoxels(const Mesh& mesh, const VoxelBox& box, double voxel_size, double tolerance)
    : kinds_(box, Kind::kNone) {
  for (std::uint32_t index = 0; index < mesh.triangles.size(); ++index) {
    const Triangle triangle = TriangleOf(mesh, index);
    const VoxelBox around = VoxelsAround(triangle, box, voxel_size, tolerance);
    for (int z = around.min.z; z < around.max.z; ++z) {
      for (int y = around.min.y; y < around.max.y; ++y) {
        for (int x = around.min.x; x < around.max.x; ++x) {
          const double depth = OverlapDepth(triangle, BoxOf({x, y, z}, voxel_size));
          if (depth < -tolerance) continue;
          const std::size_t offset = kinds_.Offset({x, y, z});
          if (depth >= tolerance) {
            kinds_[offset] = Kind::kCut;
            triangles_[offset].push_back(index);
          } else if (kinds_[offset] == Kind::kNone) {
            kinds_[offset] = Kind::kTouched;
          }
        }
      }
    }
  }
}

}  // namespace thalweg::simulator
