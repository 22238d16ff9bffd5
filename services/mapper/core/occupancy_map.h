#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/map_model.h"
#include "common/geometry/pinhole_camera.h"
#include "common/geometry/point_cloud.h"
#include "common/geometry/rigid_transform.h"
#include "common/voxel/occupancy_grid.h"
#include "services/mapper/core/depth_smoother.h"
#include "services/mapper/core/fused_map.h"
#include "services/mapper/core/map_copy.h"
#include "services/mapper/core/scan_marks.h"
#include "services/mapper/core/surface_fill.h"

namespace thalweg::mapper {

/// Occupancy of every voxel that the robot has observed, fused from point clouds.
///
/// Log-odds update with clamping [Hornung et al.: OctoMap, Autonomous Robots 34(3), 2013, Sec. 3; Eq. 2.14 of
/// the source thesis]:
///   L(n | z_1:t) = clamp(L(n | z_1:t-1) + L(n | z_t), l_min, l_max)
/// A scan updates a voxel at most once: as a hit if a point fell into it, whatever rays crossed it; else as a
/// miss if a ray from the sensor to the center of a hit voxel crossed it. With Options::OfOctomap() every
/// voxel is classified as by octomap::OcTree::insertPointCloud(cloud, origin, max_range, lazy, discretize =
/// true). As there, points are transformed to W, and rays cast, in single precision.
///
/// Departure: hashed blocks of 8^3 voxels instead of an octree, see docs/decisions/0001.
/// Threading: one thread owns the map.
class OccupancyMap final : public FusedMap {
 public:
  struct Options {
    double voxel_size = MapModel{}.voxel_size;  ///< [m]
    double max_range = MapModel{}.max_range;    ///< [m] Longer rays only clear space, up to this range.
    double min_range = 0.05;                    ///< [m] Nearer points are ignored.
    float log_odds_hit = 0.85F;                 ///< > 0
    float log_odds_miss = -0.4F;                ///< < 0
    float log_odds_min = -2.0F;                 ///< < 0
    float log_odds_max = 3.5F;                  ///< > 0
    bool protect = true;  ///< A scan does not lower an occupied voxel if it hits one of its 26 neighbors.
    bool fill = true;  ///< Between neighboring pixels on one plane, the voxels in between count as hit, too.
    /// Rays end at a measured point in the hit voxel, not at the voxel's center. A ray bent to the center may
    /// pass through a solid beside the true ray and mark its inside as free.
    bool exact_rays = true;
    double fill_max_gap =
        SurfaceFill::Options{}.max_gap;  ///< [m] Pixels whose points lie farther apart are not connected.
    /// [m] A scan clears no voxel up to this distance behind a hit, along the ray to it: a voxel partly
    /// behind a thin or grazed surface may contain some of that surface. 0 = no shadow.
    double shadow = 3.0;
    /// Largest second difference of inverse depth on a plane, relative to the inverse depth.
    double fill_tolerance = SurfaceFill::Options{}.tolerance;
    /// With a sigma > 0, depths are smoothed by DepthSmoother, and a point is a hit only if it lies in its
    /// voxel with at least min_hit_probability. Other points only clear the space up to 3 sigma before them,
    /// and lower it to OccupancyGrid::kWeaklyFree at most.
    DepthErrorModel depth_error = {};
    double min_hit_probability = 0.95;
    /// For a sensor that reports rays without a return, i.e. nothing within its range (which max_range must
    /// not exceed): pixels that are IsNoReturn, in clouds of this camera's size, clear space along their rays
    /// up to max_range. Unset: such pixels count as not measured.
    std::optional<PinholeCamera> no_return = std::nullopt;

    /// OctoMap's behavior: without the four rules that go beyond it (protect, fill, exact_rays and shadow).
    static Options OfOctomap();
  };

  /// Throws std::invalid_argument naming the bad option.
  explicit OccupancyMap(const Options& options);
  /// Resumes from a map of the same voxel size.
  OccupancyMap(const Options& options, OccupancyGrid map);

  /// Fuses one cloud into the map.
  /// @param cloud  Points in C; NaN points are skipped. fill and no_return take effect only if it is
  ///   organized.
  std::span<const VoxelChange> Integrate(const PointCloud& cloud, const RigidTransform& T_WC) override;

  std::span<const Hit> hits() const override { return hits_; }
  bool empty() const override { return grid_.block_count() == 0; }
  OccupancyGrid Snapshot() const override { return CopyOf(grid_); }

  const OccupancyGrid& grid() const { return grid_; }
  const Options& options() const { return options_; }

 private:
  void SplitByError(const PointCloud& cloud, const Eigen::Matrix3f& R_WC, const Eigen::Vector3f& p_WC);
  void CollectEnds(const PointCloud& cloud, const Eigen::Matrix3f& R_WC, const Eigen::Vector3f& p_WC,
                   std::vector<Hit>& ends);
  void AddRays(const PointCloud& cloud, const Eigen::Matrix3f& R_WC, const Eigen::Vector3f& p_WC,
               std::span<const Hit> ends, bool are_hits);
  void AddOpenRays(const PointCloud& cloud, const Eigen::Matrix3f& R_WC, const Eigen::Vector3f& p_WC);
  void CastShadows(const PointCloud& cloud, const Eigen::Matrix3f& R_WC, const Eigen::Vector3f& p_WC,
                   std::span<const Hit> ends);
  bool CanFill(const PointCloud& cloud) const;
  void FillSurfaces(const PointCloud& cloud, const Eigen::Matrix3f& R_WC, const Eigen::Vector3f& p_WC);
  void ApplyMarks();
  void ApplyBlock(const VoxelIndex& index, const std::uint8_t* marks);
  bool IsProtected(const VoxelIndex& voxel, float log_odds) const;

  Options options_;
  OccupancyGrid grid_;
  ScanMarks marks_;
  std::optional<DepthSmoother> smoother_;  ///< Set if there is a depth_error.
  /// The cloud split into its certain and uncertain points; NaN where a point belongs to the other.
  PointCloud sure_, unsure_;
  std::vector<Hit> ends_;  ///< The voxels of this scan's points, each once.
  std::vector<Hit> unsure_ends_;
  std::vector<std::uint32_t> pixel_offsets_;  ///< For fill: offset of the mark of each point's voxel.
  std::vector<Hit> hits_;                     ///< Ends within range, and filled voxels.
  std::vector<ScanMarks::Ray> rays_;
  std::array<VoxelIndex, 1024> far_seen_;  ///< Hash cache of ends beyond the window.
  std::vector<VoxelChange> changes_;
};

/// Returns the options. Throws std::invalid_argument naming the bad one.
const OccupancyMap::Options& Checked(const OccupancyMap::Options& options);

}  // namespace thalweg::mapper
