#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "services/mapper/core/octomap_file.h"

namespace thalweg::mapper {

/// What a map holds.
struct MapSummary {
  std::size_t free = 0;      ///< Voxels.
  std::size_t occupied = 0;  ///< Voxels.
  std::size_t colored = 0;   ///< Those of the occupied voxels that have a color.
  /// [m] Around all known voxels; nothing if there are none.
  std::optional<Eigen::AlignedBox3d> bounds_W;

  std::size_t known() const { return free + occupied; }
};
MapSummary Summarize(const ColoredMap& map);

/// The voxels whose centers lie in a box.
ColoredMap Crop(const ColoredMap& map, const Eigen::AlignedBox3d& box_W);

/// Adds the log-odds of a second map of the same place, as if one mapper had seen what both have seen [Eq.
/// 2.14 of the source thesis], within OctoMap's limits; a voxel known to one of them alone stays as it is. A
/// voxel's color is that of the map of which it is occupied, of `into` where both are.
/// Throws std::invalid_argument if their voxels have different sizes.
void Merge(const ColoredMap& from, ColoredMap& into);

/// A map of voxels `factor` times as large: the largest log-odds of those within, as OctoMap's inner nodes
/// have, so that nothing occupied is lost. Unknown voxels do not count.
/// @param factor  2 to 1024; throws std::invalid_argument otherwise.
ColoredMap Coarsen(const ColoredMap& map, int factor);

/// How many voxels of one size lie along an edge of a voxel of a larger size [m]: 1 if the sizes are the same
/// up to the digits with which a file states them. Nothing if they do not fit.
std::optional<int> CoarseningFactor(double voxel_size, double larger_voxel_size);

/// How a second map differs from a first one.
struct MapDifference {
  /// Voxels by their VoxelState in the first map and in the second; of those unknown to both, 0.
  std::array<std::array<std::size_t, 3>, 3> counts = {};
  std::vector<VoxelIndex> appeared;  ///< Free in the first, occupied in the second.
  std::vector<VoxelIndex> vanished;  ///< Occupied in the first, free in the second.

  std::size_t differing() const;  ///< Voxels whose states differ.
  std::size_t known_to_both() const;
  /// Share of the voxels known to both that are of the same state; nothing if there are none.
  std::optional<double> agreement() const;
};
/// Throws std::invalid_argument if their voxels have different sizes.
MapDifference DifferenceOf(const OccupancyGrid& first, const OccupancyGrid& second);

/// What appeared and what vanished, as a map of occupied voxels in green and in red.
ColoredMap PaintedDifference(const MapDifference& difference, double voxel_size);

}  // namespace thalweg::mapper
