#include "services/mapper/core/scan_points.h"

#include <bit>
#include <cmath>

#include "common/base/check.h"
#include "common/base/simd.h"

namespace thalweg::mapper {

namespace {

using Floats = std::array<float, VoxelBatch::kSize>;
using Ints = std::array<std::int32_t, VoxelBatch::kSize>;

/// One axis of ToWorld. The order of summation is part of the contract.
void ToWorldAxis(const std::array<Floats, 3>& points, const Eigen::RowVector3f& row, float offset,
                 Floats& out) {
  const float a = row[0];
  const float b = row[1];
  const float c = row[2];
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] = a * points[0][k] + b * points[1][k] + c * points[2][k] + offset;
  }
}

/// Classification of a point of a batch.
enum Verdict : std::int32_t {
  kGood = 0,
  kUnsure = 1,  ///< Too close to a voxel face to be placed in single precision.
  kBad = 2,     ///< NaN, nearer than the minimum range, or beyond the grid.
};

/// Computes floor(p / voxel_size) like VoxelAt, but in single precision, which fits twice as many values into
/// a vector, and flags the points for which the two may differ.
void FloorAxis(const Floats& p_W, double voxel_size, Ints& out, Ints& verdict) {
  constexpr float kLarge = 12582912.0F;    // 1.5 * 2^23: a sum with it has no fractional bits
  constexpr float kRelativeError = 3e-7F;  // of 1 / voxel_size and of the product: 2^-23 with a margin
  const auto inverse = static_cast<float>(1.0 / voxel_size);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const float scaled = p_W[k] * inverse;
    const float sum = scaled + kLarge;
    const float above_nearest = scaled - (sum - kLarge);
    const std::int32_t nearest = std::bit_cast<std::int32_t>(sum) - std::bit_cast<std::int32_t>(kLarge);
    out[k] = nearest - static_cast<std::int32_t>(above_nearest < 0.0F);
    const bool sure = std::abs(above_nearest) > std::abs(scaled) * kRelativeError;
    const bool inside = std::abs(scaled) < static_cast<float>(kMaxVoxelIndex);  // false for NaN
    verdict[k] |= static_cast<std::int32_t>(!sure) | static_cast<std::int32_t>(!inside) << 1;
  }
}

}  // namespace

THALWEG_SIMD_CLONES
void PlaceInVoxels(std::span<const Eigen::Vector3f> points_C, const Eigen::Matrix3f& R_WC,
                   const Eigen::Vector3f& p_WC, double voxel_size, double min_range, VoxelBatch& voxels) {
  THALWEG_CHECK(!points_C.empty() && points_C.size() <= VoxelBatch::kSize);
  std::array<Floats, 3> points;
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  const float* const packed = points_C.front().data();
  for (std::size_t k = 0; k < points_C.size(); ++k) {
    points[0][k] = packed[3 * k];
    points[1][k] = packed[3 * k + 1];
    points[2][k] = packed[3 * k + 2];
  }
  for (std::size_t k = points_C.size(); k < VoxelBatch::kSize; ++k) {
    for (Floats& axis : points) axis[k] = 0.0F;
  }
  Ints verdict;
  const auto min_squared = static_cast<float>(min_range * min_range);
  for (std::size_t k = 0; k < VoxelBatch::kSize; ++k) {
    const float squared =
        points[0][k] * points[0][k] + points[1][k] * points[1][k] + points[2][k] * points[2][k];
    verdict[k] = static_cast<std::int32_t>(!(squared >= min_squared)) << 1;
  }
  Floats world;
  Ints* const out[3] = {&voxels.x, &voxels.y, &voxels.z};
  for (int axis = 0; axis < 3; ++axis) {
    ToWorldAxis(points, R_WC.row(axis), p_WC[axis], world);
    FloorAxis(world, voxel_size, *out[axis], verdict);
  }
  for (std::size_t k = 0; k < points_C.size(); ++k) {
    if (verdict[k] == kGood) continue;
    if (verdict[k] >= kBad) {
      voxels.x[k] = VoxelBatch::kNone;
      continue;
    }
    const VoxelIndex voxel = VoxelAt(ToWorld(R_WC, p_WC, points_C[k]).cast<double>(), voxel_size);
    voxels.x[k] = voxel.x;
    voxels.y[k] = voxel.y;
    voxels.z[k] = voxel.z;
  }
}

}  // namespace thalweg::mapper
