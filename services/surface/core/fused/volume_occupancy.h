#pragma once

#include <cmath>
#include <numbers>

#include "common/voxel/occupancy_grid.h"
#include "services/surface/core/fused/truncated_volume.h"

namespace thalweg::surface {

/// Voxels of an occupancy grid are cubes of so many voxels of the volume, along each axis.
inline constexpr int kOccupancyBits = 2;

/// What a volume says of occupancy, coarsely: a cube is occupied if a surface or what is behind it is in one
/// of its voxels, else free if one of them is known. Far from surfaces, nothing is known.
inline OccupancyGrid OccupancyOf(const TruncatedVolume& volume) {
  const double voxel = volume.voxel_size();
  OccupancyGrid grid(voxel * (1 << kOccupancyBits));
  const auto half_diagonal = static_cast<float>(0.5 * std::numbers::sqrt3 * voxel);
  volume.ForEachBlock([&](const VoxelIndex& index, const TruncatedVolume::Block& block) {
    constexpr int kEdge = TruncatedVolume::kEdge;
    VoxelIndex i;
    for (i.z = 0; i.z < kEdge; ++i.z) {
      for (i.y = 0; i.y < kEdge; ++i.y) {
        for (i.x = 0; i.x < kEdge; ++i.x) {
          const SurfaceVoxel& its = block.voxels[TruncatedVolume::OffsetOf(i.x, i.y, i.z)];
          if (!its.known()) continue;
          const VoxelIndex cube{(index.x * kEdge + i.x) >> kOccupancyBits,
                                (index.y * kEdge + i.y) >> kOccupancyBits,
                                (index.z * kEdge + i.z) >> kOccupancyBits};
          if (!InIndexRange(cube)) continue;
          const bool solid = its.distance <= half_diagonal;
          if (solid || grid.State(cube) == VoxelState::kUnknown) grid.Set(cube, solid ? 1.0F : -1.0F);
        }
      }
    }
  });
  return grid;
}

}  // namespace thalweg::surface
