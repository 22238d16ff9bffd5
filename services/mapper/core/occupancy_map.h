#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/pinhole_camera.h"
#include "common/geometry/point_cloud.h"
#include "common/geometry/rigid_transform.h"
#include "common/voxel/occupancy_grid.h"
#include "services/mapper/core/depth_smoother.h"
#include "services/mapper/core/scan_marks.h"

namespace thalweg::mapper {

/// Occupancy of every voxel that the robot has observed, fused from point clouds.
///
/// Log-odds update with clamping [Hornung et al.: OctoMap, Autonomous Robots 34(3), 2013, Sec. 3; Eq. 2.14 of
/// the source thesis]:
///   L(n | z_1:t) = clamp(L(n | z_1:t-1) + L(n | z_t), l_min, l_max)
/// A scan changes a voxel once: hit when a point fell into it, whatever else crossed it; else miss when a ray
/// from the sensor to the centre of a hit voxel crossed it. With Options::OfOctomap() every voxel has the
/// class that octomap::OcTree::insertPointCloud(cloud, origin, max_range, lazy, discretize = true) gives it.
/// As there, points are placed in W, and rays cast, in single precision. Departure: hashed blocks of 8^3
/// voxels instead of an octree, see docs/decisions/0001. Threading: one thread owns the map.
class OccupancyMap {
 public:
  struct Options {
    double voxel_size = 0.10;     ///< [m]
    double max_range = 5.0;       ///< [m] Longer rays only clear space up to it.
    double min_range = 0.05;      ///< [m] Nearer points are ignored.
    float log_odds_hit = 0.85F;   ///< > 0
    float log_odds_miss = -0.4F;  ///< < 0
    float log_odds_min = -2.0F;   ///< < 0
    float log_odds_max = 3.5F;    ///< > 0
    bool protect = true;  ///< An occupied voxel is not lowered by a scan that hits one of its 26 neighbours.
    bool fill = true;     ///< Between neighbouring pixels on one plane, the voxels in between are hit, too.
    /// Rays end at a measured point of the voxel that is hit, not at its centre. A ray that is bent to the
    /// centre may pass through solids beside the true one and call their inside free.
    bool exact_rays = true;
    double fill_max_gap = 0.4;  ///< [m] Pixels further apart are not joined.
    /// [m] So far behind each voxel that is hit, along a ray to it, a scan frees nothing: what lies partly
    /// behind a thin or grazed surface may hold some of it. 0 = none.
    double shadow = 3.0;
    double fill_tolerance = 0.004;  ///< Of inverse depth: largest second difference that still is a plane.
    /// With a sigma, depths are smoothed as DepthSmoother does, and a point is a hit only where it lies in
    /// its voxel with min_hit_probability; others only clear the space up to 3 sigma before them, and that to
    /// OccupancyGrid::kWeaklyFree at most.
    DepthErrorModel depth_error = {};
    double min_hit_probability = 0.95;
    /// Of a sensor that tells where nothing is within its range, which max_range must not exceed: pixels of
    /// clouds of this camera's size that are IsNoReturn clear space up to max_range along its rays. None:
    /// such pixels are no measurements.
    std::optional<PinholeCamera> no_return = std::nullopt;

    /// Without the four rules that go beyond OctoMap: protect, fill, exact_rays and shadow.
    static Options OfOctomap();
  };

  /// Throws std::invalid_argument naming the bad option.
  explicit OccupancyMap(const Options& options);
  /// Goes on from a map of the same voxel size.
  OccupancyMap(const Options& options, OccupancyGrid map);

  /// Fuses one cloud. @param cloud  Organised (fill and no_return need it), in C; NaN points are skipped.
  /// @param T_WC  Pose of the camera at the cloud's stamp.
  /// @return Voxels whose log-odds changed, each once; valid until the next call.
  std::span<const VoxelChange> Integrate(const PointCloud& cloud, const RigidTransform& T_WC);

  /// A voxel that a scan says is occupied.
  struct Hit {
    VoxelIndex voxel;
    std::uint32_t pixel = 0;  ///< A point of the cloud that lies in it or, when it was filled, beside it.
  };
  /// Of the last cloud, each voxel once; valid until the next call of Integrate.
  std::span<const Hit> hits() const { return hits_; }

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
  std::optional<DepthSmoother> smoother_;  ///< With a depth_error.
  PointCloud sure_, unsure_;               ///< The cloud split in two; NaN where a point is of the other.
  std::vector<Hit> ends_;                  ///< Voxels of this scan's points, each once.
  std::vector<Hit> unsure_ends_;
  std::vector<std::uint32_t> pixel_offsets_;  ///< For fill: where the mark of each point's voxel is.
  std::vector<Hit> hits_;                     ///< Those within range, and the filled ones.
  std::vector<ScanMarks::Ray> rays_;
  std::array<VoxelIndex, 1024> far_seen_;  ///< Some of the ends beyond the window, by hash.
  std::vector<VoxelChange> changes_;
};

}  // namespace thalweg::mapper
