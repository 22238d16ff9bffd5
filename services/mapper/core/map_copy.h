#pragma once

#include "common/voxel/occupancy_grid.h"

namespace thalweg::mapper {

/// A grid of its own with the same voxels. O(blocks).
inline OccupancyGrid CopyOf(const OccupancyGrid& grid) {
  OccupancyGrid copy(grid.voxel_size());
  grid.ForEachBlock(
      [&copy](const VoxelIndex& index, const OccupancyGrid::Block& block) { copy.BlockAt(index) = block; });
  return copy;
}

}  // namespace thalweg::mapper
