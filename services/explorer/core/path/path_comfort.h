#pragma once

#include <vector>

#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

struct PathComfort {
  double distance = 0.1;  ///< [m] Beyond the map's clearance, where there is room. 0 = as the path came.
  double reach = 0.35;    ///< [m] No further than that from the path as it came.
  double price = 3.0;     ///< A metre without any of that distance counts as 1 + price metres.
};

/// Leads a path further off what is near it, where there is room.
///
/// A map calls voxels free through which a surface passes when no ray has hit it there: its walls are known
/// to a voxel. A path that keeps the robot's clearance from occupied and unknown voxels may so come nearer to
/// a surface by up to that; one that has room need not. Shortest path, by length and comfort, through the
/// traversable voxels within `reach` of the path; then pulled straight without giving comfort up.
/// @param path_W  From the robot to a place in a traversable voxel; both ends stay.
std::vector<Eigen::Vector3d> MakeComfortable(const PlanningMap& map,
                                             const std::vector<Eigen::Vector3d>& path_W,
                                             const PathComfort& options);

}  // namespace thalweg::explorer
