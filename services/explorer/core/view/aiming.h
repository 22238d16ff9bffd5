#pragma once

#include <vector>

#include "services/explorer/core/view/view.h"

namespace thalweg::explorer {

/// Cuts a path short at the first point from which the robot has half of those target voxels in view that it
/// has in view at the end of the path.
/// @param path_W      [m] Starts at the robot; at least one point.
/// @param look_range  [m] Distance within which a voxel counts as in view.
void StopWhereSeen(const PlanningMap& map, const ViewPlanner& views, double look_range,
                   const std::vector<VoxelIndex>& target, std::vector<Eigen::Vector3d>& path_W);

/// The view from a position that shows the most target voxels and, among equals, the most unknown voxels that
/// are not set aside.
/// @param sightings  From that position.
/// @param set_aside  Over the map's box; nonzero = does not count.
/// @param R_WB       The present orientation; of equal views the one nearest to it is chosen.
View BestViewOf(const std::vector<VoxelIndex>& target, const std::vector<Sighting>& sightings,
                const DenseGrid<std::uint8_t>& set_aside, const ViewPlanner& views,
                const Eigen::Matrix3d& R_WB);

}  // namespace thalweg::explorer
