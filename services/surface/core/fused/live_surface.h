#pragma once

#include <span>
#include <unordered_set>
#include <utility>
#include <vector>

#include "services/surface/core/fused/fused_surface.h"
#include "services/surface/core/fused/surface_mesh.h"

namespace thalweg::surface {

/// A fused surface and its mesh, with what has changed since the mesh followed, and since copies were taken:
/// both cost more than fusing one cloud, and are done for many at a time.
///
/// Threading: one thread at a time.
class LiveSurface {
 public:
  /// Goes on with a volume of the options' voxel size. Throws std::invalid_argument naming a bad option.
  LiveSurface(const FusedSurface::Options& options, TruncatedVolume volume)
      : surface_(options, std::move(volume)), mesh_(options.limits) {
    surface_.volume().ForEachBlock([this](const VoxelIndex& index, const auto&) { unmeshed_.insert(index); });
    UpdateMesh();
  }

  /// As FusedSurface::Fuse.
  void Fuse(const PointCloud& cloud, const PinholeCamera& camera, const RigidTransform& T_WC) {
    const auto changed = surface_.Fuse(cloud, camera, T_WC);
    unmeshed_.insert(changed.begin(), changed.end());
    uncopied_.insert(changed.begin(), changed.end());
  }
  /// Brings the mesh up to date. Returns the blocks whose meshes are new, valid until the next call.
  std::span<const VoxelIndex> UpdateMesh() {
    const std::vector<VoxelIndex> changed(unmeshed_.begin(), unmeshed_.end());
    unmeshed_.clear();
    return mesh_.Update(surface_.volume(), changed);
  }
  /// Copies of the blocks that have changed since the last call.
  TruncatedVolume TakeChanged() {
    TruncatedVolume copies(surface_.volume().voxel_size());
    for (const VoxelIndex& index : uncopied_) copies.At(index) = *surface_.volume().Find(index);
    uncopied_.clear();
    return copies;
  }

  const FusedSurface& surface() const { return surface_; }
  const SurfaceMesh& mesh() const { return mesh_; }  ///< As of the last UpdateMesh.

 private:
  using Blocks = std::unordered_set<VoxelIndex, VoxelIndexHash>;
  FusedSurface surface_;
  SurfaceMesh mesh_;
  Blocks unmeshed_;
  Blocks uncopied_;
};

}  // namespace thalweg::surface
