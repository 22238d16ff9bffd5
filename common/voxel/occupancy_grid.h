#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <unordered_map>

#include "common/voxel/dense_grid.h"
#include "common/voxel/voxel_index.h"

namespace thalweg {

/// One voxel that has a new value.
struct VoxelChange {
  VoxelIndex voxel;
  float log_odds;  ///< The new value; NaN = unknown.
};

/// Log-odds of occupancy, sparse: hashed blocks of 8^3 voxels. What the mapper computes, and what every
/// reader of map updates holds a copy of. NaN = never observed.
/// Threading: one thread owns a grid.
class OccupancyGrid {
 public:
  static constexpr int kBlockBits = 3;
  static constexpr int kBlockEdge = 1 << kBlockBits;
  static constexpr int kBlockVoxels = kBlockEdge * kBlockEdge * kBlockEdge;
  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

  /// Log-odds of the block's voxels, x fastest, then y, then z.
  using Block = std::array<float, kBlockVoxels>;

  /// @param voxel_size  [m] edge; throws std::invalid_argument unless finite and > 0.
  explicit OccupancyGrid(double voxel_size);

  double voxel_size() const { return voxel_size_; }
  VoxelIndex IndexOf(const Eigen::Vector3d& p_W) const { return VoxelAt(p_W, voxel_size_); }
  Eigen::Vector3d CenterOf(const VoxelIndex& i) const { return VoxelCenter(i, voxel_size_); }

  /// To such log odds, and not lower, a voxel is brought by rays whose ends are not sure, as a noisy sensor's
  /// from afar: it is free, but a thin thing may be there, and one sure hit is enough to say so.
  static constexpr float kWeaklyFree = -0.2F;
  static bool IsWeaklyFree(float log_odds) { return log_odds < 0.0F && log_odds >= kWeaklyFree; }

  /// Of a voxel's log-odds; p = 0.5 counts as occupied, as in OctoMap.
  static VoxelState StateOf(float log_odds) {
    if (std::isnan(log_odds)) return VoxelState::kUnknown;
    return log_odds >= 0.0F ? VoxelState::kOccupied : VoxelState::kFree;
  }

  float LogOdds(const VoxelIndex& i) const {
    const Block* block = FindBlock(BlockOf(i));
    return block ? (*block)[OffsetInBlock(i)] : kUnknown;
  }
  VoxelState State(const VoxelIndex& i) const { return StateOf(LogOdds(i)); }
  void Set(const VoxelIndex& i, float log_odds) { BlockAt(BlockOf(i))[OffsetInBlock(i)] = log_odds; }

  /// Block b holds the voxels [8 b, 8 b + 8) on each axis.
  static VoxelIndex BlockOf(const VoxelIndex& i) {
    return {i.x >> kBlockBits, i.y >> kBlockBits, i.z >> kBlockBits};
  }
  static std::size_t OffsetInBlock(const VoxelIndex& i) {
    constexpr int kMask = kBlockEdge - 1;
    return static_cast<std::size_t>((((i.z & kMask) << kBlockBits) | (i.y & kMask)) << kBlockBits |
                                    (i.x & kMask));
  }
  static VoxelIndex IndexInBlock(const VoxelIndex& block, std::size_t offset) {
    constexpr std::size_t kMask = kBlockEdge - 1;
    return {block.x * kBlockEdge + static_cast<std::int32_t>(offset & kMask),
            block.y * kBlockEdge + static_cast<std::int32_t>((offset >> kBlockBits) & kMask),
            block.z * kBlockEdge + static_cast<std::int32_t>(offset >> (2 * kBlockBits))};
  }

  const Block* FindBlock(const VoxelIndex& block) const {
    const auto found = blocks_.find(block);
    return found == blocks_.end() ? nullptr : found->second.get();
  }
  /// Makes the block, all unknown, where there is none. References stay valid until Clear().
  Block& BlockAt(const VoxelIndex& block);

  std::size_t block_count() const { return blocks_.size(); }
  /// Calls visit(block index, block) for each block, in no particular order.
  template <class Visitor>
  void ForEachBlock(Visitor&& visit) const {
    for (const auto& [index, block] : blocks_) visit(index, *block);
  }
  /// Calls visit(voxel index, log-odds) for each known voxel, in no particular order.
  template <class Visitor>
  void ForEachKnown(Visitor&& visit) const {
    ForEachBlock([&](const VoxelIndex& index, const Block& block) {
      for (std::size_t k = 0; k < block.size(); ++k) {
        if (!std::isnan(block[k])) visit(IndexInBlock(index, k), block[k]);
      }
    });
  }

  void Clear() { blocks_.clear(); }
  /// Same known voxels with bitwise the same log-odds.
  bool SameAs(const OccupancyGrid& other) const;

 private:
  double voxel_size_;
  std::unordered_map<VoxelIndex, std::unique_ptr<Block>, VoxelIndexHash> blocks_;
};

}  // namespace thalweg
