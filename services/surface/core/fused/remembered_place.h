#pragma once

#include "common/geometry/point_cloud.h"
#include "common/geometry/rigid_transform.h"
#include "common/voxel/map_agreement.h"
#include "common/voxel/occupancy_grid.h"
#include "services/surface/core/fused/truncated_volume.h"

namespace thalweg::surface {

/// What a volume knew at some time of the place, to tell whether clouds are of another one.
///
/// A volume knows nothing far from surfaces. So a ray that leaves what it knows proves nothing, as it does in
/// an occupancy map: most rays past an edge do. A ray contradicts the volume only if it enters a surface from
/// the side from which that was seen, and goes on behind it.
/// Memory: 4 bytes for each voxel in a block of the volume. Threading: one thread.
class RememberedPlace {
 public:
  explicit RememberedPlace(const TruncatedVolume& volume);

  /// Which rays of a cloud agree: those that end within 0.25 m of a surface; and which contradict: those that
  /// go through one more than that before their end.
  /// @param cloud      Points in C; of many, some thousand are taken.
  /// @param max_range  [m] Rays are followed up to this range.
  MapAgreement Compare(const PointCloud& cloud, const RigidTransform& T_WC, double max_range) const;

 private:
  bool EndsAtSurface(const Eigen::Vector3d& end_W) const;
  bool GoesThroughSurface(const Eigen::Vector3d& from_W, const Eigen::Vector3d& end_W) const;

  int cube_bits_;         ///< An edge of a cube is 2 to this power voxels.
  OccupancyGrid depths_;  ///< [voxels] For each known voxel of the volume, how far it is behind the surface.
  OccupancyGrid cubes_;   ///< Occupied where a surface is.
};

}  // namespace thalweg::surface
