#pragma once

#include <optional>
#include <vector>

#include "services/simulator/core/truth.h"
#include "services/simulator/core/visibility.h"

namespace thalweg::simulator {

/// Which observable voxels of a true map are in view from a single position, by the same tests that decide
/// which are observable from any: the center of a free voxel is in sight, or a point of the surface inside a
/// surface voxel, within range. The camera looks in all directions, or in those of a level camera.
/// Threading: const calls from any number of threads.
class VoxelSight {
 public:
  /// @param world    Must outlive the object.
  /// @param start_W  A position for which the truth holds.
  /// @param options  Those of the truth.
  VoxelSight(const World& world, const TrueMap& truth, const Eigen::Vector3d& start_W,
             const TrueMap::Options& options);

  /// The observable voxels, in grid order.
  const std::vector<VoxelIndex>& voxels() const { return voxels_; }
  /// Whether voxel n of voxels() is in view from a body at `p_W`. The camera is at the body's center; a level
  /// camera is at its height above it.
  bool Sees(const Eigen::Vector3d& p_W, std::size_t n) const;

 private:
  const World& world_;
  double voxel_size_;
  double view_range_;
  std::optional<LevelCamera> level_;
  std::vector<VoxelIndex> voxels_;
  /// The points to look at for voxel n are those from first_aim_[n] to first_aim_[n + 1]; a free voxel has
  /// none, because its center is looked at.
  std::vector<std::size_t> first_aim_;
  std::vector<Eigen::Vector3d> aims_;
};

}  // namespace thalweg::simulator
