#pragma once

#include <optional>
#include <unordered_set>
#include <utility>
#include <vector>

#include "common/geometry/cloud_camera.h"
#include "services/surface/core/fused/fused_surface.h"
#include "services/surface/core/fused/mesh_rifts.h"
#include "services/surface/core/fused/surface_mesh.h"

namespace thalweg::surface {

/// A fused surface, its mesh and its rifts, with what has changed since the mesh followed, since rifts were
/// found, and since copies were taken: each costs more than fusing one cloud, and is done for many at a time.
///
/// Threading: one thread at a time.
class LiveSurface {
 public:
  /// Goes on with a volume of the options' voxel size. Throws std::invalid_argument naming a bad option.
  LiveSurface(const FusedSurface::Options& options, TruncatedVolume volume)
      : surface_(options, std::move(volume)),
        mesh_(options.limits),
        rifts_(options.voxel_size, options.depth_error) {
    surface_.volume().ForEachBlock([this](const VoxelIndex& index, const auto&) { unmeshed_.insert(index); });
    UpdateMesh();
    untaken_.clear();
  }

  /// As FusedSurface::Fuse.
  void Fuse(const PointCloud& cloud, const PinholeCamera& camera, const RigidTransform& T_WC) {
    const auto changed = surface_.Fuse(cloud, camera, T_WC);
    unmeshed_.insert(changed.begin(), changed.end());
    uncopied_.insert(changed.begin(), changed.end());
    const auto looked_at_C = PointLookedAt(cloud, camera, surface_.options().max_range);
    if (looked_at_C) looked_at_W_ = T_WC * looked_at_C->cast<double>();
  }
  /// Brings the mesh up to date.
  void UpdateMesh() {
    const std::vector<VoxelIndex> changed(unmeshed_.begin(), unmeshed_.end());
    unmeshed_.clear();
    const auto updated = mesh_.Update(surface_.volume(), changed);
    unsearched_.insert(updated.begin(), updated.end());
    untaken_.insert(updated.begin(), updated.end());
  }
  /// Brings the mesh up to date. Returns the blocks whose meshes are newer than the last call, or than the
  /// given volume.
  std::vector<VoxelIndex> TakeUpdated() {
    UpdateMesh();
    std::vector<VoxelIndex> updated(untaken_.begin(), untaken_.end());
    untaken_.clear();
    return updated;
  }
  /// Finds the rifts of the mesh. Distances are from what the camera of the last cloud looks at.
  const MeshRifts& FindRifts() {
    const std::vector<VoxelIndex> updated(unsearched_.begin(), unsearched_.end());
    unsearched_.clear();
    rifts_.Update(mesh_, updated);
    rifts_.Find(mesh_, looked_at_W_);
    return rifts_;
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
  const MeshRifts& rifts() const { return rifts_; }  ///< As of the last FindRifts.

 private:
  using Blocks = std::unordered_set<VoxelIndex, VoxelIndexHash>;
  FusedSurface surface_;
  SurfaceMesh mesh_;
  MeshRifts rifts_;
  std::optional<Eigen::Vector3d> looked_at_W_;
  Blocks unmeshed_;
  Blocks unsearched_;  ///< Blocks whose meshes are newer than the rifts,
  Blocks untaken_;     ///< than what was taken.
  Blocks uncopied_;
};

}  // namespace thalweg::surface
