#pragma once

#include <vector>

#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// Bends the corners of a path into curves that a robot need not slow down for as much, where there is space.
///
/// A robot of lateral acceleration a passes a curve of radius r at sqrt(a r), and a corner hardly at all. The
/// path is sampled, and its points are moved, one after another and several times, to where their neighbors'
/// line bends least (the minimum of the sum of squared second differences), as long as the body keeps the
/// clearance that it had there, or `keep`, if that is less. Then corners are cut [Chaikin, An algorithm
/// for high-speed curve generation, CGIP 3(4), 1974] until none is sharper than the controller takes in full
/// flight.
/// @param path_W  From the robot; both ends stay.
/// @param keep    [m] Clearance that the path was given where there is space.
/// @param moving  Whether the robot moves along the first segment already, which then stays as well.
/// @return        The path itself where it has no corner, or a curve is nowhere clear.
std::vector<Eigen::Vector3d> MakeFlyable(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W,
                                         double keep, bool moving);

}  // namespace thalweg::explorer
