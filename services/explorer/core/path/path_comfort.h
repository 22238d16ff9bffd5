#pragma once

#include <vector>

#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

struct PathComfort {
  double distance = 0.1;  ///< [m] Beyond the map's clearance, where there is room. 0 = leave paths alone.
  double reach = 0.35;    ///< [m] No further than this from the original path.
  double price = 3.0;     ///< A meter without any of that distance costs 1 + price meters.
};

/// Leads a path further away from obstacles, where there is room.
///
/// A map calls a voxel free although a surface passes through it when no ray has hit the surface there: walls
/// are known to within a voxel. A path that keeps the robot's clearance from occupied and unknown voxels may
/// therefore come nearer to a surface by up to a voxel; where there is room it need not. Finds the shortest
/// path, by length and comfort, through the traversable voxels within `reach` of the path, and pulls it
/// straight without giving up comfort.
/// @param path_W  From the robot to a place in a traversable voxel; both ends stay.
std::vector<Eigen::Vector3d> MakeComfortable(const PlanningMap& map,
                                             const std::vector<Eigen::Vector3d>& path_W,
                                             const PathComfort& options);

}  // namespace thalweg::explorer
