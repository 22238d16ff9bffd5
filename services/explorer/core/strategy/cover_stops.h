#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

// What a tour of Cover may be made of.

inline constexpr double kPocket = 0.5;  ///< [m] Unknown voxels that near to an item do not block the sight.

/// A sample of a cluster, which is to be seen.
struct CoverItem {
  VoxelIndex voxel;
  std::size_t candidate;
  double share;  ///< The part of its cluster that it stands for.
  bool is_far = false;
};

/// [m] Clusters at the end of longer paths are planned for by zones.
inline constexpr double kFarPath = 10.0;

/// Samples of the clusters of all candidates; fewer of each where there are many, one of each that is far.
/// @param far  [m] Path from which on a cluster is far.
std::vector<CoverItem> SampleItems(const Situation& situation, double far = kFarPath);

/// A position to look from, and what may be seen from there.
struct CoverStop {
  VoxelIndex place;
  std::vector<std::size_t> items = {};  ///< Increasing indices.
  /// The view to take. Empty = as many as show something, where turning costs nothing.
  std::optional<Eigen::Matrix3d> R_WB = {};
  bool is_here = false;  ///< The robot is there.
  bool is_zone = false;  ///< It stands for a zone of far clusters, see ZoneStops.
};

/// [m] The body's position at a stop.
Eigen::Vector3d PositionOf(const CoverStop& stop, const Situation& situation);

/// Stops in a lattice: in each cell the reached voxel that is crossed by most rays from the items outward.
/// Near an item, unknown voxels do not block the sight: they are likely to be the same pocket. Those of far
/// clusters are left out.
/// @param rays  From SpreadRays.
std::vector<CoverStop> StopsSeeing(const Situation& situation, const std::vector<CoverItem>& items,
                                   const std::vector<std::vector<RayStep>>& rays);

/// The views from a stop that show any of its items, but for those that show nothing that another does not
/// show as well. Of two that show the same, the one that has it nearer to the middle of its image.
std::vector<CoverStop> ViewsFrom(const CoverStop& stop, const Situation& situation,
                                 const std::vector<CoverItem>& items);

/// Stops for zones of far clusters, whose first goals lie in the same cell of 2 m and at the end of paths of
/// about the same length. What is to be seen there from where, and in which order, need not be planned before
/// the robot comes near. A zone's stop is the first goal of its nearest cluster, with a view of it, and
/// counts as showing all of the zone.
std::vector<CoverStop> ZoneStops(const Situation& situation, const std::vector<CoverItem>& items);

/// Keeps some stops for each item: those that see most items, and those nearest to the robot.
void KeepFew(const Situation& situation, std::size_t items, std::vector<CoverStop>& stops);

}  // namespace thalweg::explorer
