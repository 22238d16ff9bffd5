#pragma once

#include <cstdint>
#include <span>

#include "common/geometry/point_cloud.h"
#include "common/geometry/rigid_transform.h"
#include "common/voxel/occupancy_grid.h"

namespace thalweg::mapper {

/// A voxel that a scan found occupied.
struct Hit {
  VoxelIndex voxel;
  /// Index of a point of the cloud in the voxel; for a filled voxel, of one beside it.
  std::uint32_t pixel = 0;
};

/// A map that is fused from point clouds: all that the mapper's service, and an exploration in lock step,
/// need of one. It is stored and published as the values of its voxels, whatever it computes with; an engine
/// continues from such values where it, or another one, has stopped.
///
/// Threading: one thread owns a map.
class FusedMap {
 public:
  virtual ~FusedMap() = default;

  /// Fuses one cloud into the map.
  /// @param cloud  Points in C; NaN points are skipped.
  /// @param T_WC  Pose of the camera at the cloud's stamp.
  /// @return Voxels whose log-odds changed, each once; valid until the next call.
  virtual std::span<const VoxelChange> Integrate(const PointCloud& cloud, const RigidTransform& T_WC) = 0;
  /// Hits of the last cloud, each voxel once; valid until the next call of Integrate.
  virtual std::span<const Hit> hits() const = 0;
  virtual bool empty() const = 0;  ///< Whether no voxel is known.
  /// A copy of all known voxels. O(known voxels).
  virtual OccupancyGrid Snapshot() const = 0;
};

}  // namespace thalweg::mapper
