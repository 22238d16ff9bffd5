#include "services/simulator/core/surface_voxels.h"

#include "common/geometry/triangle.h"
#include "common/voxel/for_each_voxel.h"

namespace thalweg::simulator {
namespace {

/// The voxels of `box` that intersect a triangle's bounding box grown by `margin`.
VoxelBox VoxelsAround(const Triangle& triangle, const VoxelBox& box, double voxel_size, double margin) {
  Eigen::AlignedBox3d extent;
  for (const Eigen::Vector3d& corner : triangle) extent.extend(corner);
  const Eigen::Vector3d grow = Eigen::Vector3d::Constant(margin);
  const VoxelIndex low = VoxelAt(extent.min() - grow, voxel_size);
  const VoxelIndex high = VoxelAt(extent.max() + grow, voxel_size);
  return Intersection({low, high + VoxelIndex{1, 1, 1}}, box);
}

}  // namespace

SurfaceVoxels::SurfaceVoxels(const Mesh& mesh, const VoxelBox& box, double voxel_size, double tolerance)
    : kinds_(box, Kind::kNone) {
  for (std::uint32_t index = 0; index < mesh.triangles.size(); ++index) {
    const Triangle triangle = TriangleOf(mesh, index);
    const VoxelBox around = VoxelsAround(triangle, box, voxel_size, tolerance);
    ForEachVoxel(around, [&](const VoxelIndex& i) {
      const double depth = OverlapDepth(triangle, BoxOf(i, voxel_size));
      if (depth < -tolerance) return;
      const std::size_t offset = kinds_.Offset(i);
      if (depth >= tolerance) {
        kinds_[offset] = Kind::kCut;
        triangles_[offset].push_back(index);
      } else if (kinds_[offset] == Kind::kNone) {
        kinds_[offset] = Kind::kTouched;
      }
    });
  }
}

}  // namespace thalweg::simulator
