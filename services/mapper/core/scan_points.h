#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "common/voxel/voxel_index.h"

namespace thalweg::mapper {

/// Transforms a point from C to W: R p + t in single precision, as OctoMap stores its points, summed from
/// left to right.
inline Eigen::Vector3f ToWorld(const Eigen::Matrix3f& R_WC, const Eigen::Vector3f& p_WC,
                               const Eigen::Vector3f& p_C) {
  return R_WC.col(0) * p_C.x() + R_WC.col(1) * p_C.y() + R_WC.col(2) * p_C.z() + p_WC;
}

/// The voxel indices of a batch of points, one array per axis, so that the compiler vectorizes the loops.
struct VoxelBatch {
  static constexpr std::size_t kSize = 256;
  static constexpr std::int32_t kNone = std::numeric_limits<std::int32_t>::min();

  std::array<std::int32_t, kSize> x;  ///< kNone: not measured, too near, or beyond the grid.
  std::array<std::int32_t, kSize> y;
  std::array<std::int32_t, kSize> z;
};

/// Computes the voxel of each point, VoxelAt(ToWorld(p)).
/// @param points_C  1 to VoxelBatch::kSize points.
void PlaceInVoxels(std::span<const Eigen::Vector3f> points_C, const Eigen::Matrix3f& R_WC,
                   const Eigen::Vector3f& p_WC, double voxel_size, double min_range, VoxelBatch& voxels);

}  // namespace thalweg::mapper
