#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "services/explorer/core/path/path_search.h"

namespace thalweg::explorer {

/// The planning map in cells of 3 x 3 x 3 voxels: for path lengths between many places, to within a few
/// tenths, and for how much is unknown behind a frontier.
///
/// A cell is open when a voxel in it can be reached. The robot goes over from one to a face neighbour where
/// two voxels in reach face each other, and diagonally where it could go around the corner; cells so small
/// lie on one side of any wall that the map knows. A cell is dark when most of it is unknown and within the
/// bounds; dark cells that share faces make a region, that is cut off from others even where a wall has gaps
/// of a voxel.
/// Threading: one thread.
class CoarseMap {
 public:
  static constexpr int kEdge = 3;  ///< [voxels]

  CoarseMap(const PlanningMap& map, const PathSearch& search);  ///< Keeps both by reference.

  /// [m] of the shortest paths between reached voxels, all to all; where cells are too coarse to find one, of
  /// the way over the robot.
  std::vector<std::vector<double>> Distances(const std::vector<VoxelIndex>& places);
  /// The same from one of them.
  std::vector<double> DistancesFrom(const VoxelIndex& place, std::span<const VoxelIndex> others);

  /// What is unknown behind groups of unknown voxels: each dark region is worth worth(its voxels), divided
  /// among the groups that touch it by how many of their voxels do.
  std::vector<double> WorthBehind(const std::vector<const std::vector<VoxelIndex>*>& groups,
                                  const std::function<double(double)>& worth) const;

  std::size_t known_voxels() const { return known_; }

 private:
  std::size_t CellOf(const VoxelIndex& voxel) const;
  void FindEdges();
  /// costs_ from a cell, until those of the wanted ones are known.
  void Flood(std::size_t start, std::span<const std::size_t> wanted);
  void FindRegions();

  const PathSearch& search_;
  double voxel_size_;
  VoxelIndex origin_;
  VoxelBox cells_box_;
  DenseGrid<std::uint8_t> exits_;   ///< Open, and to which face neighbours.
  DenseGrid<std::uint32_t> edges_;  ///< Bits, to which of the 26 neighbours there is a way.
  struct Step {
    std::uint32_t to;  ///< Offset of a cell,
    std::uint32_t by;  ///< and the neighbour's bit that led to it.
  };
  static constexpr std::size_t kBuckets = 256;       ///< More than the dearest step.
  std::array<std::vector<Step>, kBuckets> buckets_;  ///< Empty between floods.
  std::vector<std::uint32_t> costs_;                 ///< [hundredths of a cell] Of the last flood.
  DenseGrid<std::uint8_t> unknown_;                  ///< Voxels of each cell.
  DenseGrid<std::int32_t> region_;                   ///< -1 = not dark
  std::vector<std::size_t> region_volume_;
  std::size_t known_ = 0;
};

}  // namespace thalweg::explorer
