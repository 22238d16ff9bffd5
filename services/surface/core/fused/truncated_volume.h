#pragma once

#include <array>
#include <memory>
#include <unordered_map>

#include "common/voxel/voxel_index.h"
#include "services/surface/core/fused/surface_voxel.h"

namespace thalweg::surface {

/// Signed distances to the surface, in hashed blocks of 8^3 voxels that exist only near it [Nießner et al.,
/// Real-time 3D reconstruction at scale using voxel hashing, ACM TOG 32(6), 2013, Sec. 4]. A voxel's value
/// holds for its center.
///
/// Threading: one thread owns a volume.
class TruncatedVolume {
 public:
  static constexpr int kEdgeBits = 3;
  static constexpr int kEdge = 1 << kEdgeBits;
  static constexpr std::size_t kVoxels = kEdge * kEdge * kEdge;
  struct Block {
    std::array<SurfaceVoxel, kVoxels> voxels;  ///< x fastest, then y, then z.
    bool has_inside = false;                   ///< Whether a known voxel is behind a surface.
  };

  static constexpr std::size_t kBlockBytes = sizeof(Block);

  /// @param voxel_size  [m] > 0
  explicit TruncatedVolume(double voxel_size) : voxel_size_(voxel_size) {}

  double voxel_size() const { return voxel_size_; }
  double block_size() const { return voxel_size_ * kEdge; }  ///< [m]

  static std::size_t OffsetOf(int x, int y, int z) {
    return static_cast<std::size_t>((z << kEdgeBits | y) << kEdgeBits | x);
  }
  const Block* Find(const VoxelIndex& block) const {
    const auto found = blocks_.find(block);
    return found == blocks_.end() ? nullptr : found->second.get();
  }
  Block* Find(const VoxelIndex& block) {
    const auto found = blocks_.find(block);
    return found == blocks_.end() ? nullptr : found->second.get();
  }
  /// Returns the block, made of unknown voxels if there is none. References stay valid.
  Block& At(const VoxelIndex& block) {
    std::unique_ptr<Block>& entry = blocks_[block];
    if (!entry) entry = std::make_unique<Block>();
    return *entry;
  }
  /// Unknown voxels where there is no block.
  SurfaceVoxel VoxelAt(const VoxelIndex& i) const {
    const Block* block = Find({i.x >> kEdgeBits, i.y >> kEdgeBits, i.z >> kEdgeBits});
    return block ? block->voxels[OffsetOf(i.x & (kEdge - 1), i.y & (kEdge - 1), i.z & (kEdge - 1))]
                 : SurfaceVoxel{};
  }

  std::size_t block_count() const { return blocks_.size(); }
  std::size_t bytes() const { return blocks_.size() * sizeof(Block); }
  /// Calls visit(block index, block) for each block, in no particular order.
  template <class Visitor>
  void ForEachBlock(Visitor&& visit) const {
    for (const auto& [index, block] : blocks_) visit(index, *block);
  }
  template <class Visitor>
  void ForEachBlock(Visitor&& visit) {
    for (auto& [index, block] : blocks_) visit(index, *block);
  }

 private:
  double voxel_size_;
  std::unordered_map<VoxelIndex, std::unique_ptr<Block>, VoxelIndexHash> blocks_;
};

}  // namespace thalweg::surface
