#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "common/voxel/dense_grid.h"

namespace thalweg {

/// The voxels that overlap a box in space; overlaps as thin as a rounding error do not count.
inline VoxelBox VoxelsWithin(const Eigen::AlignedBox3d& bounds, double voxel_size) {
  constexpr double kSliver = 1e-6;
  const auto low = [&](int axis) {
    return static_cast<std::int32_t>(std::floor(bounds.min()[axis] / voxel_size + kSliver));
  };
  const auto high = [&](int axis) {
    return static_cast<std::int32_t>(std::ceil(bounds.max()[axis] / voxel_size - kSliver));
  };
  return {{low(0), low(1), low(2)}, {high(0), high(1), high(2)}};
}

}  // namespace thalweg
