#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "services/surface/core/fused/truncated_volume.h"

namespace thalweg::surface {

/// The part of the surface in the cells of one block: those whose lowest corner is the center of one of its
/// voxels.
struct BlockMesh {
  struct Vertex {
    Eigen::Vector3f p_W;
    Eigen::Vector3f normal_W;  ///< Unit length, away from the solid.
    Rgb color{128, 128, 128};
    PackedQuality best;  ///< The nearer voxel's.
    /// The voxel edge that it is on: axis + 3 (x + 9 (y + 9 z)) from voxel (x, y, z), each 0 to 8, of the
    /// block. Neighboring blocks have vertices in common, on edges between voxels of coordinate 8 here, 0
    /// there.
    std::uint16_t edge = 0;
  };
  std::vector<Vertex> vertices;
  std::vector<std::array<std::uint16_t, 3>> faces;  ///< Counterclockwise as seen from free space.

  bool empty() const { return faces.empty(); }
};

/// The zero level of a block's distances by marching cubes. A vertex is where linear interpolation along an
/// edge between two voxels, of distances a < 0 and b >= 0, has its zero: the share a / (a - b) of the way.
/// Its normal is the gradient of the distances, by central differences, interpolated likewise.
///
/// Cells with an unknown corner have no surface, so that it ends where nothing was seen. Nor has a cell with
/// an edge through the surface along which the distance changes by more than twice the edge's length: by more
/// than one length it cannot change before and behind one surface, and such an edge is between a surface that
/// is seen and free space beside it.
BlockMesh MeshOf(const TruncatedVolume& volume, const VoxelIndex& block);

}  // namespace thalweg::surface
