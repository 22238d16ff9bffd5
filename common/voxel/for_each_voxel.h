#pragma once

#include <algorithm>
#include <type_traits>
#include <utility>

#include "common/voxel/dense_grid.h"

namespace thalweg {

/// The cube of (2 reach + 1)^3 voxels around a voxel.
inline VoxelBox CubeAround(const VoxelIndex& center, int reach) {
  const VoxelIndex reaches{reach, reach, reach};
  return {center - reaches, center + reaches + VoxelIndex{1, 1, 1}};
}

/// Calls visit(VoxelIndex) for each voxel of a box, in the order of DenseGrid: x fastest, then y, then z.
/// @param visit  May return bool: false stops the iteration.
/// @return Whether all voxels were visited.
template <class Visitor>
bool ForEachVoxel(const VoxelBox& box, Visitor&& visit) {
  VoxelIndex i;
  for (i.z = box.min.z; i.z < box.max.z; ++i.z) {
    for (i.y = box.min.y; i.y < box.max.y; ++i.y) {
      for (i.x = box.min.x; i.x < box.max.x; ++i.x) {
        if constexpr (std::is_same_v<std::invoke_result_t<Visitor&, const VoxelIndex&>, bool>) {
          if (!visit(std::as_const(i))) return false;
        } else {
          visit(std::as_const(i));
        }
      }
    }
  }
  return true;
}

/// The voxels in both boxes; empty, i.e. count() is 0, if there are none.
inline VoxelBox Intersection(const VoxelBox& a, const VoxelBox& b) {
  return {{std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y), std::max(a.min.z, b.min.z)},
          {std::min(a.max.x, b.max.x), std::min(a.max.y, b.max.y), std::min(a.max.z, b.max.z)}};
}

}  // namespace thalweg
