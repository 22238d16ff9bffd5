#pragma once

#include <vector>

#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// Whether an unknown voxel is to be explored: within the bounds, and not set aside.
bool IsOpenUnknown(const PlanningMap& map, const DenseGrid<std::uint8_t>& set_aside, const VoxelIndex& i);

/// The frontier of the source thesis: the free voxels within the bounds that have at least one unknown face
/// neighbor [Shade: Choosing Where To Go, DPhil thesis, Oxford 2011, Ch. 6]. In the order of the grid.
/// @param set_aside  Over the map's box; unknown voxels where it is not zero do not count.
std::vector<VoxelIndex> FreeFrontier(const PlanningMap& map, const DenseGrid<std::uint8_t>& set_aside);

}  // namespace thalweg::explorer
