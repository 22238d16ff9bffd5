#include "services/mapper/core/scan_points.h"

#include "common/base/check.h"

namespace thalweg::mapper {

namespace {

using Floats = std::array<float, VoxelBatch::kSize>;
using Ints = std::array<std::int32_t, VoxelBatch::kSize>;

/// One axis of ToWorld. The order of the sums is part of the contract.
void ToWorldAxis(const std::array<Floats, 3>& points, const Eigen::RowVector3f& row, float offset,
                 Floats& out) {
  const float a = row[0];
  const float b = row[1];
  const float c = row[2];
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] = a * points[0][k] + b * points[1][k] + c * points[2][k] + offset;
  }
}

/// floor(p / voxel_size), as VoxelAt; what is not finite, or beyond the grid, comes out beyond the grid.
void FloorAxis(const Floats& p_W, double inverse_voxel_size, Ints& out) {
  constexpr double kBeyond = 2.0 * kMaxVoxelIndex;
  for (std::size_t k = 0; k < out.size(); ++k) {
    double scaled = static_cast<double>(p_W[k]) * inverse_voxel_size;
    scaled = scaled > -kBeyond ? scaled : -kBeyond;  // NaN, too
    scaled = scaled < kBeyond ? scaled : kBeyond;
    const auto truncated = static_cast<std::int32_t>(scaled);
    out[k] = truncated - (static_cast<double>(truncated) > scaled ? 1 : 0);
  }
}

}  // namespace

void PlaceInVoxels(std::span<const Eigen::Vector3f> points_C, const Eigen::Matrix3f& R_WC,
                   const Eigen::Vector3f& p_WC, double voxel_size, double min_range, VoxelBatch& voxels) {
  THALWEG_CHECK(points_C.size() <= VoxelBatch::kSize);
  std::array<Floats, 3> points;
  for (std::size_t k = 0; k < points_C.size(); ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) points[axis][k] = points_C[k][static_cast<int>(axis)];
  }
  for (std::size_t k = points_C.size(); k < VoxelBatch::kSize; ++k) {
    for (Floats& axis : points) axis[k] = 0.0F;
  }
  Floats world;
  const double inverse = 1.0 / voxel_size;
  Ints* const out[3] = {&voxels.x, &voxels.y, &voxels.z};
  for (int axis = 0; axis < 3; ++axis) {
    ToWorldAxis(points, R_WC.row(axis), p_WC[axis], world);
    FloorAxis(world, inverse, *out[axis]);
  }
  const auto min_squared = static_cast<float>(min_range * min_range);
  constexpr std::uint32_t kSpan = 2U * kMaxVoxelIndex;
  for (std::size_t k = 0; k < VoxelBatch::kSize; ++k) {
    const float squared =
        points[0][k] * points[0][k] + points[1][k] * points[1][k] + points[2][k] * points[2][k];
    const auto beyond = [](std::int32_t v) { return static_cast<std::uint32_t>(v + kMaxVoxelIndex) > kSpan; };
    const bool good = squared >= min_squared;  // false for NaN
    const bool none = !good | beyond(voxels.x[k]) | beyond(voxels.y[k]) | beyond(voxels.z[k]);
    voxels.x[k] = none ? VoxelBatch::kNone : voxels.x[k];
  }
}

}  // namespace thalweg::mapper
