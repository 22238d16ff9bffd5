#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <unordered_map>

#include "common/voxel/dense_grid.h"
#include "common/voxel/voxel_index.h"

namespace thalweg {

/// A voxel whose value has changed.
struct VoxelChange {
  VoxelIndex voxel;
  float log_odds;  ///< The new value; NaN = unknown.
};

/// Log-odds of occupancy, stored sparsely in hashed blocks of 8^3 voxels. The mapper computes such a grid,
/// and every reader of map updates keeps a copy of it. NaN = never observed.
///
/// Threading: one thread owns a grid.
class OccupancyGrid {
 public:
  static constexpr int kBlockBits = 3;
  static constexpr int kBlockEdge = 1 << kBlockBits;
  static constexpr int kBlockVoxels = kBlockEdge * kBlockEdge * kBlockEdge;
  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

  /// Log-odds of the block's voxels, x fastest, then y, then z.
  using Block = std::array<float, kBlockVoxels>;

  /// @param voxel_size  [m] Edge of a voxel. Throws std::invalid_argument unless finite and > 0.
  explicit OccupancyGrid(double voxel_size);

  double voxel_size() const { return voxel_size_; }
  VoxelIndex IndexOf(const Eigen::Vector3d& p_W) const { return VoxelAt(p_W, voxel_size_); }
  Eigen::Vector3d CenterOf(const VoxelIndex& i) const { return VoxelCenter(i, voxel_size_); }

  /// Lower limit of log-odds for voxels cleared only by rays whose ends are uncertain, such as those of a
  /// noisy sensor from afar. Such a voxel is free, but may still contain something thin, and a single certain
  /// hit makes it occupied.
  static constexpr float kWeaklyFree = -0.2F;
  static bool IsWeaklyFree(float log_odds) { return log_odds < 0.0F && log_odds >= kWeaklyFree; }

  /// State for the given log-odds; p = 0.5 counts as occupied, as in OctoMap.
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

  /// Block b contains the voxels [8 b, 8 b + 8) along each axis.
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
  /// Returns the block, creating it with unknown voxels if needed. References stay valid until Clear().
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
  /// Whether the same voxels are known, with bitwise equal log-odds.
  bool SameAs(const OccupancyGrid& other) const;

 private:
  double voxel_size_;
  std::unordered_map<VoxelIndex, std::unique_ptr<Block>, VoxelIndexHash> blocks_;
};

}  // namespace thalweg
