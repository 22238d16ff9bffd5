#include "services/simulator/core/voxel_sight.h"

#include <cmath>

#include "services/simulator/core/surface_voxels.h"

namespace thalweg::simulator {

VoxelSight::VoxelSight(const World& world, const TrueMap& truth, const Eigen::Vector3d& start_W,
                       const TrueMap::Options& options)
    : world_(world),
      voxel_size_(options.voxel_size),
      view_range_(options.view_range),
      level_(TrueMap::CameraOf(options, start_W)) {
  const DenseGrid<TrueVoxel>& kinds = truth.voxels();
  const SurfaceVoxels surfaces(world.mesh(), kinds.box(), voxel_size_, kTouchTolerance);
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i] != TrueVoxel::kFree && kinds[i] != TrueVoxel::kSurface) continue;
    voxels_.push_back(kinds.IndexAt(i));
    first_aim_.push_back(aims_.size());
    if (kinds[i] != TrueVoxel::kSurface) continue;
    for (const SurfacePatch& patch :
         PatchesIn(BoxOf(voxels_.back(), voxel_size_), world.mesh(), surfaces.TrianglesAt(i))) {
      aims_.insert(aims_.end(), patch.aims.begin(), patch.aims.end());
    }
  }
  first_aim_.push_back(aims_.size());
}

bool VoxelSight::Sees(const Eigen::Vector3d& p_W, std::size_t n) const {
  const Eigen::Vector3d eye_W = level_ ? level_->EyeOf(p_W) : p_W;
  const Eigen::Vector3d center_W = VoxelCenter(voxels_[n], voxel_size_);
  if ((center_W - eye_W).norm() > view_range_ + voxel_size_) return false;  // no point of it is near enough
  const auto in_view = [&](const Eigen::Vector3d& target_W) {
    return (target_W - eye_W).norm() <= view_range_ && (!level_ || level_->Sees(eye_W, target_W));
  };
  if (first_aim_[n] == first_aim_[n + 1]) return in_view(center_W) && world_.InSight(eye_W, center_W);
  const Eigen::AlignedBox3d box = BoxOf(voxels_[n], voxel_size_);
  for (std::size_t a = first_aim_[n]; a < first_aim_[n + 1]; ++a) {
    if (in_view(aims_[a]) && SeesAim(world_, box, eye_W, aims_[a], view_range_)) return true;
  }
  return false;
}

}  // namespace thalweg::simulator
