#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace thalweg {

/// Voxel i spans [i, i + 1) * voxel_size in W along each axis.
struct VoxelIndex {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t z = 0;

  bool operator==(const VoxelIndex&) const = default;
  VoxelIndex operator+(const VoxelIndex& o) const { return {x + o.x, y + o.y, z + o.z}; }
  VoxelIndex operator-(const VoxelIndex& o) const { return {x - o.x, y - o.y, z - o.z}; }
};

/// 16 bits per axis, as OctoMap's keys. Indices beyond are rejected where data enters.
constexpr std::int32_t kMaxVoxelIndex = 32767;

inline bool InIndexRange(const VoxelIndex& i) {
  const auto fits = [](std::int32_t v) { return v >= -kMaxVoxelIndex - 1 && v <= kMaxVoxelIndex; };
  return fits(i.x) && fits(i.y) && fits(i.z);
}

inline VoxelIndex VoxelAt(const Eigen::Vector3d& p_W, double voxel_size) {
  const double inverse = 1.0 / voxel_size;  // like OctoMap: multiply, then floor
  return {static_cast<std::int32_t>(std::floor(p_W.x() * inverse)),
          static_cast<std::int32_t>(std::floor(p_W.y() * inverse)),
          static_cast<std::int32_t>(std::floor(p_W.z() * inverse))};
}

inline Eigen::Vector3d VoxelCenter(const VoxelIndex& i, double voxel_size) {
  return {(i.x + 0.5) * voxel_size, (i.y + 0.5) * voxel_size, (i.z + 0.5) * voxel_size};
}

enum class VoxelState : std::uint8_t { kUnknown = 0, kFree = 1, kOccupied = 2 };

/// The six face neighbors.
inline constexpr VoxelIndex kFaceNeighbors[6] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                                 {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};

struct VoxelIndexHash {
  std::size_t operator()(const VoxelIndex& i) const {
    const auto key = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(i.x)) * 0x9E3779B185EBCA87ULL) ^
                     (static_cast<std::uint64_t>(static_cast<std::uint32_t>(i.y)) * 0xC2B2AE3D27D4EB4FULL) ^
                     (static_cast<std::uint64_t>(static_cast<std::uint32_t>(i.z)) * 0x165667B19E3779F9ULL);
    return static_cast<std::size_t>(key ^ (key >> 32));
  }
};

}  // namespace thalweg
