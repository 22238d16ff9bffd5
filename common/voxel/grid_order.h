#pragma once

#include <tuple>

#include "common/voxel/voxel_index.h"

namespace thalweg {

/// The order of a grid's voxels in memory: x runs fastest, then y, then z.
struct GridOrder {
  bool operator()(const VoxelIndex& a, const VoxelIndex& b) const {
    return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
  }
};

}  // namespace thalweg
