#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "services/explorer/core/path/path_search.h"

namespace thalweg::explorer {

/// To the four voxels beside one at its height.
inline constexpr std::span<const VoxelIndex> kStepsInPlane(kFaceNeighbors, 4);

/// What a robot that drives can go around: the middle [m], at the plane's height, of the occupied space in
/// the band that voxels which it can reach enclose; of several, the first in the map's order. Nothing if the
/// map knows none, so that all that it knows as the robot's free space is simply connected; or has no plane.
///
/// Enclosed is what no steps across faces, in the plane and past voxels that the robot can reach, connect
/// with the map's outside. Unknown space that is enclosed without anything occupied is no island: nothing may
/// stand there. Nor is a no-go box, which no sight ends at.
/// @param search  Flooded from the robot. O(voxels of a layer).
std::optional<Eigen::Vector3d> FindIsland(const PlanningMap& map, const PathSearch& search);

}  // namespace thalweg::explorer
