#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "common/geometry/point_cloud.h"
#include "common/geometry/rigid_transform.h"
#include "common/voxel/occupancy_grid.h"

namespace thalweg {

/// How many rays of a cloud a map explains, and how many it contradicts; the others cross what it does not
/// know.
struct MapAgreement {
  std::size_t agreeing = 0;
  std::size_t contradicting = 0;

  std::size_t known() const { return agreeing + contradicting; }
  /// Whether the cloud was taken in another place than the map, or places it elsewhere. Floors and ceilings
  /// agree in most places, and furniture moves, hence the share.
  bool IsOfAnotherPlace() const {
    constexpr std::size_t kLeast = 50;
    constexpr double kShare = 0.3;
    return contradicting >= kLeast &&
           static_cast<double>(contradicting) > kShare * static_cast<double>(known());
  }
  /// Whether there is enough to judge by.
  bool IsTelling() const { return known() >= 100; }
};
/// Says so, for people. Precondition: IsOfAnotherPlace().
/// @param file  File that the map was read from.
std::string AnotherPlaceText(const MapAgreement& agreement, const std::string& file);

enum class RayVerdict { kUnknown, kAgrees, kContradicts };

/// Judges the measured rays of a cloud; of many, some thousand.
/// @param cloud      Points in C.
/// @param T_WC       Pose of the camera at the cloud's stamp.
/// @param max_range  [m] Rays are followed up to this range.
/// @param farthest   [m] Rays that lead farther from the origin on some axis are left out.
/// @param verdict    (from_W, end_W, ends_in_range): of a ray up to its point, or up to max_range.
MapAgreement JudgeRays(
    const PointCloud& cloud, const RigidTransform& T_WC, double max_range, double farthest,
    const std::function<RayVerdict(const Eigen::Vector3d& from_W, const Eigen::Vector3d& end_W,
                                   bool ends_in_range)>& verdict);

/// Compares a cloud with the map. A ray contradicts it if it passes through a surface into what was never
/// seen, or ends in the middle of free space; it agrees if it ends at a surface. Surfaces may be 0.25 m, at
/// least one voxel, from where the map has them, as after a drift of the odometry.
/// @param cloud      Points in C; of many, some thousand are taken.
/// @param T_WC       Pose of the camera at the cloud's stamp.
/// @param max_range  [m] Rays are followed up to this range.
MapAgreement Compare(const OccupancyGrid& grid, const PointCloud& cloud, const RigidTransform& T_WC,
                     double max_range);

}  // namespace thalweg
