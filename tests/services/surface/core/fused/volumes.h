#pragma once

#include <vector>

#include "services/surface/core/fused/truncated_volume.h"

/// Volumes whose distances are known in closed form.
namespace thalweg::surface::test {

/// A volume of known voxels, by default of 3^3 blocks.
/// @param distance_of(x, y, z)  [m] At the center of a voxel.
/// @param low, high             The first voxel along each axis, and the last.
template <class DistanceOf>
TruncatedVolume VolumeOf(double voxel_size, DistanceOf&& distance_of, const VoxelIndex& low = {-8, -8, -8},
                         const VoxelIndex& high = {15, 15, 15}) {
  TruncatedVolume volume(voxel_size);
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) {
        TruncatedVolume::Block& block = volume.At({x >> 3, y >> 3, z >> 3});
        block.has_inside = true;
        SurfaceVoxel& voxel = block.voxels[TruncatedVolume::OffsetOf(x & 7, y & 7, z & 7)];
        voxel.distance = static_cast<float>(distance_of(x, y, z));
        voxel.weight = 1.0F;
      }
    }
  }
  return volume;
}

inline std::vector<VoxelIndex> AllBlocks(const TruncatedVolume& volume) {
  std::vector<VoxelIndex> blocks;
  volume.ForEachBlock([&](const VoxelIndex& index, const auto&) { blocks.push_back(index); });
  return blocks;
}

inline SurfaceVoxel& VoxelOf(TruncatedVolume& volume, int x, int y, int z) {
  return volume.At({x >> 3, y >> 3, z >> 3}).voxels[TruncatedVolume::OffsetOf(x & 7, y & 7, z & 7)];
}

/// Makes the voxels from `low` to `high`, both included, known or unknown: a hole in the surface there is one
/// voxel wider than they are, from center to center of those beside them.
inline void SetKnown(TruncatedVolume& volume, const VoxelIndex& low, const VoxelIndex& high, bool known) {
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) VoxelOf(volume, x, y, z).weight = known ? 1.0F : 0.0F;
    }
  }
}

}  // namespace thalweg::surface::test
