#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include "services/surface/core/fused/mesh_vertex.h"
#include "services/surface/core/fused/surface_mesh.h"

namespace thalweg::surface {

/// An edge of exactly one face: the surface ends there.
struct BorderEdge {
  MeshVertex::Id from = 0;  ///< The face is on the left, as seen from free space.
  MeshVertex::Id to = 0;
  std::uint16_t from_index = 0;  ///< Index of the vertex in the mesh of the edge's block.
  std::uint16_t to_index = 0;

  bool operator==(const BorderEdge&) const = default;
};

/// The open border of a mesh, kept up to date with it. What blocks have in common counts once: an edge
/// between two blocks is of the border if only one of them has a face there.
///
/// A segment of marching cubes lies in one face between two cells, so that only the six neighbors of a block
/// whose mesh is new are looked at again, and those only if the block's own open edges have changed.
class MeshBorder {
 public:
  using Edges = std::vector<BorderEdge>;

  /// @param updated  What SurfaceMesh::Update returned.
  void Update(const SurfaceMesh& mesh, std::span<const VoxelIndex> updated);

  /// By block, in ascending order of their ends; without blocks that have none.
  const std::unordered_map<VoxelIndex, Edges, VoxelIndexHash>& edges() const { return border_; }

 private:
  bool GoesOn(const VoxelIndex& block, const BorderEdge& edge) const;

  using EdgesByBlock = std::unordered_map<VoxelIndex, Edges, VoxelIndexHash>;
  EdgesByBlock open_;  ///< Edges of one face of the block; in ascending order of their ends.
  EdgesByBlock border_;
};

}  // namespace thalweg::surface
