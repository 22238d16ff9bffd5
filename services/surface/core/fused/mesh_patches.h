#pragma once

#include <limits>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "services/surface/core/fused/mesh_vertex.h"
#include "services/surface/core/fused/surface_mesh.h"

namespace thalweg::surface {

/// The connected pieces of each block of a mesh, and which of them have vertices in common: a graph as coarse
/// as the blocks, on which paths over the surface are found. Kept up to date with the mesh.
///
/// The length of a path is that of the straight lines between its ends and the centroids of the patches that
/// it leads over. It is right to a block's edge and, as over a grid with diagonals, 8 %; along the mesh's own
/// edges it would be up to 41 % too long, since the diagonals of its cells all lie one way.
class MeshPatches {
 public:
  using Id = std::uint32_t;  ///< Stays until the next update.

  struct Place {
    Id patch = 0;
    Eigen::Vector3f p_W = Eigen::Vector3f::Zero();
  };

  /// @param updated  What SurfaceMesh::Update returned.
  void Update(const SurfaceMesh& mesh, std::span<const VoxelIndex> updated);

  /// The patches of all vertices in the mesh of a block, which must not be empty.
  const std::vector<Id>& PatchesOf(const VoxelIndex& block) const;
  /// The vertex nearest to a point, if there is one in the blocks around it.
  /// @param mesh  As of the last update.
  std::optional<Place> Nearest(const SurfaceMesh& mesh, const Eigen::Vector3d& p_W, double voxel_size) const;

  /// Shortest paths from one place.
  class Paths {
   public:
    Paths(const MeshPatches& patches, const Place& start);
    /// [m] Infinity if no path leads there.
    double To(const Place& place) const;

   private:
    const MeshPatches& patches_;
    Place start_;
    std::vector<double> lengths_;  ///< [m] To the centroids of patches; 0 for that of the start.
  };

 private:
  struct Patch {
    Eigen::Vector3f center_W = Eigen::Vector3f::Zero();
    std::vector<MeshVertex::Id> rim;  ///< Vertices that other blocks may have; ascending.
    std::vector<Id> neighbors;
  };
  struct Block {
    std::vector<Id> patch_of_vertex;
    std::vector<Id> patches;
  };
  struct Pieces;
  static Pieces PiecesOf(const VoxelIndex& block, const BlockMesh& mesh);
  bool Refresh(const VoxelIndex& block, const BlockMesh* mesh);
  void Connect(const VoxelIndex& block);

  std::unordered_map<VoxelIndex, Block, VoxelIndexHash> blocks_;
  std::vector<Patch> patches_;
  std::vector<Id> unused_;
};

}  // namespace thalweg::surface
