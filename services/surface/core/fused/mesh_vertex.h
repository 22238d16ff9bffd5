#pragma once

#include <cstdint>

#include "services/surface/core/fused/block_mesh.h"

namespace thalweg::surface {

/// A vertex of the mesh, the same in all blocks that have it: the edge between two voxels that it is on.
struct MeshVertex {
  VoxelIndex voxel;  ///< The edge's lower end.
  int axis = 0;

  /// @param edge  As in BlockMesh::Vertex.
  static MeshVertex Of(const VoxelIndex& block, std::uint16_t edge) {
    constexpr int kVoxels = TruncatedVolume::kEdge;
    constexpr int kCorners = kVoxels + 1;
    const int corner = edge / 3;
    return {{block.x * kVoxels + corner % kCorners, block.y * kVoxels + corner / kCorners % kCorners,
             block.z * kVoxels + corner / (kCorners * kCorners)},
            edge % 3};
  }

  /// Identifies the vertex, for voxels from -2^19 to 2^19 - 1 along each axis.
  using Id = std::uint64_t;
  Id id() const {
    const auto bits = [](std::int32_t i) {
      return static_cast<Id>(static_cast<std::uint32_t>(i) & 0xFFFFFU);
    };
    return bits(voxel.x) << 42 | bits(voxel.y) << 22 | bits(voxel.z) << 2 | static_cast<Id>(axis);
  }
  static MeshVertex Of(Id id) {
    const auto part = [id](int shift) {  // 20 bits with their sign
      return static_cast<std::int32_t>(static_cast<std::uint32_t>(id >> shift) << 12) >> 12;
    };
    return {{part(42), part(22), part(2)}, static_cast<int>(id & 3)};
  }
};

/// The block of a voxel.
inline VoxelIndex BlockOf(const VoxelIndex& voxel) {
  constexpr int kBits = TruncatedVolume::kEdgeBits;
  return {voxel.x >> kBits, voxel.y >> kBits, voxel.z >> kBits};
}

/// Whether a vertex of a block's mesh may be of another block's, too.
inline bool IsOnRim(const VoxelIndex& block, const MeshVertex& vertex) {
  constexpr int kVoxels = TruncatedVolume::kEdge;
  const auto is_at_end = [](int first, int i) { return i == first * kVoxels || i == (first + 1) * kVoxels; };
  return is_at_end(block.x, vertex.voxel.x) || is_at_end(block.y, vertex.voxel.y) ||
         is_at_end(block.z, vertex.voxel.z);
}

}  // namespace thalweg::surface
