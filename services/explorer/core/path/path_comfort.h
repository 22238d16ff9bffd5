#pragma once

#include <vector>

#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

struct PathComfort {
  /// [m] Wanted beyond the map's clearance, where there is space; 0 = leave paths as they are.
  double distance = 0.1;
  double reach = 0.35;  ///< [m] Largest distance from the original path.
  double price = 3.0;   ///< A meter without any of that distance costs 1 + price meters.
};

/// Moves a path away from obstacles where there is space.
///
/// A map marks a voxel free although a surface passes through it when no ray has hit the surface there, so
/// walls are known only to within a voxel. A path that keeps the robot's clearance from occupied and unknown
/// voxels may therefore come up to a voxel nearer to a surface; where there is space, it need not. This
/// function finds the path of least cost, by length and comfort, through the traversable voxels within
/// `reach` of the given path, and straightens it without giving up comfort.
/// @param path_W  From the robot to a position in a traversable voxel; both ends stay.
std::vector<Eigen::Vector3d> MakeComfortable(const PlanningMap& map,
                                             const std::vector<Eigen::Vector3d>& path_W,
                                             const PathComfort& options);

/// As MakeComfortable, but over points at half the distance of the voxels' centers, so that a body also goes
/// through the middle of a gap in which no voxel has its center. The given path may be narrower.
/// @param path_W     From the robot to the center of a voxel, near to which the new path ends.
/// @param clearance  [m] Kept from occupied and unknown voxels, but where the path begins nearer to one.
/// @return Empty when there is no such path within `reach`.
std::vector<Eigen::Vector3d> FindWiderPath(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W,
                                           double clearance, const PathComfort& options);

}  // namespace thalweg::explorer
