#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "services/explorer/core/path/path_search.h"

namespace thalweg::explorer {

/// Whether the robot reaches less than half of the space in which it fits, or fits nowhere.
/// @param flooded  From the robot.
bool IsShutIn(const PlanningMap& map, const PathSearch& flooded);

/// Why a robot is shut in, measured where it stands.
struct ShutIn {
  enum class Side : std::uint8_t { kBeside, kBelow, kAbove };

  double radius = 0.0;  ///< [m] The body without its margin.
  double needed = 0.0;  ///< [m] The clearance that it keeps: its radius and margin.
  double here = 0.0;    ///< [m] The clearance that it has, see PlanningMap::ClearanceAt; at most `needed`.
  Side side = Side::kBeside;  ///< Where the obstacle lies that leaves no more; without one, kBeside.
  /// [m] The largest clearance, to half a voxel, with which it would not be shut in; absent if there is none.
  std::optional<double> fitting = {};
};
/// Costs a rebuild of the map for each half voxel of clearance that is tried.
/// @param radius     [m] Radius of the body, without margin.
/// @param exemption  The one with which the robot looked for a path.
ShutIn WhyShutIn(const PlanningMap& map, const Eigen::Vector3d& p_W, double radius,
                 const PathSearch::Exemption& exemption);

}  // namespace thalweg::explorer
