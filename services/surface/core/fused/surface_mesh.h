#pragma once

#include <array>
#include <span>
#include <unordered_map>
#include <vector>

#include "services/surface/core/fused/block_mesh.h"

namespace thalweg::surface {

/// One mesh of everything.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices_W;
  std::vector<Eigen::Vector3f> normals_W;           ///< Per vertex, unit length.
  std::vector<Rgb> colors;                          ///< Per vertex.
  std::vector<std::array<std::uint32_t, 3>> faces;  ///< Counterclockwise as seen from free space.
};

/// How much of a surface was seen how well.
struct SurfaceArea {
  double seen = 0.0;       ///< [m^2]
  double inspected = 0.0;  ///< [m^2] Seen near and square enough by one view, see InspectionLimits.
  double fine = 0.0;       ///< [m^2] Sampled finely enough.
};

/// The mesh of a fused surface, block by block, kept up to date with its volume.
///
/// Threading: one thread owns a mesh.
class SurfaceMesh {
 public:
  explicit SurfaceMesh(const InspectionLimits& limits) : limits_(limits) {}

  /// Extracts the meshes that depend on the given blocks.
  /// @param changed  What FusedSurface::Fuse returned.
  /// @return The blocks whose meshes are new, each once, also when they have become empty; valid until the
  ///   next call.
  std::span<const VoxelIndex> Update(const TruncatedVolume& volume, std::span<const VoxelIndex> changed);

  /// Without those that are empty.
  const std::unordered_map<VoxelIndex, BlockMesh, VoxelIndexHash>& blocks() const { return blocks_; }
  /// A face counts with the share of its corners. The sum over all blocks, kept up to date.
  const SurfaceArea& area() const { return area_; }

  /// All blocks, in order, with the vertices in common joined.
  TriangleMesh Joined() const;

 private:
  void Count(const BlockMesh& mesh, double sign);

  InspectionLimits limits_;
  std::unordered_map<VoxelIndex, BlockMesh, VoxelIndexHash> blocks_;
  SurfaceArea area_;
  std::vector<VoxelIndex> updated_;
};

}  // namespace thalweg::surface
