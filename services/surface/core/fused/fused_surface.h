#pragma once

#include <Eigen/Geometry>
#include <span>
#include <unordered_set>
#include <vector>

#include "common/geometry/depth_error.h"
#include "common/geometry/pinhole_camera.h"
#include "common/geometry/point_cloud.h"
#include "common/geometry/rigid_transform.h"
#include "services/surface/core/fused/pixel_planes.h"
#include "services/surface/core/fused/truncated_volume.h"

namespace thalweg::surface {

/// The surface of all that was seen, fused from organized clouds into a truncated signed distance volume
/// [Curless, Levoy 1996; Nießner et al. 2013].
///
/// A voxel's center x is projected into the image. The plane of the pixel nearest to it gives the distance d
/// to the surface, exact where the surface is flat. Where its four surrounding pixels do not see one surface,
/// only centers within half a voxel of the pixel's own ray are updated. Weights follow from what is uncertain
/// about d: the voxel v, the spacing s = z / (f cosine) of the samples, and the sensor's error, sigma_d:
///   w = v^2 / (v^2 + s^2 + d^2 + 12 sigma_d^2)
/// (a uniform error over v has the variance v^2 / 12; d^2, since near a corner the nearer one of two surfaces
/// counts). d is truncated at (sqrt(3) + 1) v + 3 sigma_d, so that
/// all corners of a cell that the surface crosses are known, and their neighbors. Beyond, before the surface,
/// blocks that exist hear that they are free: from all four pixels, and only of a view that samples the place
/// no more coarsely than the view that saw a surface there, since a coarser one may look past it. A
/// measurement takes part if the place of its surface is known to a voxel: sigma_d <= v.
///
/// Memory grows with the surface, not with the number of clouds. Threading: one thread owns a surface.
class FusedSurface {
 public:
  struct Options {
    double voxel_size = 0.02;          ///< [m]
    double min_depth = 0.05;           ///< [m] Nearer points are ignored.
    double max_range = 8.0;            ///< [m] Points farther from the camera are ignored.
    DepthErrorModel depth_error = {};  ///< The sensor's.
    InspectionLimits limits = {};
    std::size_t most_bytes = 2'000'000'000;  ///< Memory that the volume may take.
  };
  /// Throws std::invalid_argument naming the bad option.
  explicit FusedSurface(const Options& options);
  /// Goes on with a volume of the same voxel size.
  FusedSurface(const Options& options, TruncatedVolume volume);

  /// Fuses one cloud.
  /// @param cloud  Organized, in C, of the camera's size; points that are not finite are not measured.
  /// @return The blocks that changed, each once; valid until the next call.
  std::span<const VoxelIndex> Fuse(const PointCloud& cloud, const PinholeCamera& camera,
                                   const RigidTransform& T_WC);

  const Options& options() const { return options_; }
  const TruncatedVolume& volume() const { return volume_; }
  /// Whether the volume takes most_bytes: no new surface is added, what is known goes on being fused.
  bool full() const { return volume_.bytes() + TruncatedVolume::kBlockBytes > options_.most_bytes; }

 private:
  struct Sight;
  void AddBlocks(const PointCloud& cloud, const RigidTransform& T_WC);
  void AddBlocksAround(const Eigen::AlignedBox3f& patch_W);
  bool FuseInto(TruncatedVolume::Block& block, const VoxelIndex& index, const Sight& sight);
  bool FuseInto(SurfaceVoxel& voxel, const Eigen::Vector3f& p_C, const Sight& sight) const;
  bool IsUsed(const PixelPlane& plane, const Eigen::Vector3f& p_C) const;

  Options options_;
  TruncatedVolume volume_;
  PixelPlanes planes_;
  std::unordered_set<VoxelIndex, VoxelIndexHash> near_;  ///< Blocks at the surface that the cloud shows.
  VoxelIndex last_low_, last_high_;                      ///< Blocks that were noted last.
  std::vector<VoxelIndex> changed_;
};

}  // namespace thalweg::surface
