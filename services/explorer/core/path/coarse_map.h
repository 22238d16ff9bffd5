#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "services/explorer/core/path/path_search.h"

namespace thalweg::explorer {

/// The planning map at the scale of cells of 3 x 3 x 3 voxels. It approximates path lengths between many
/// positions, to within about 20 %, and estimates how much unknown space lies behind a frontier.
///
/// A cell is open when a voxel in it can be reached. Two cells that share a face are connected where two
/// reached voxels face each other, and cells that share an edge or a corner where the robot could go around
/// it; cells are small enough to lie on one side of any known wall. A cell is dark when most of it is unknown
/// and within the bounds. Dark cells that share faces form a region, which stays separate from others even
/// where a wall has gaps of one voxel.
/// Threading: one thread.
class CoarseMap {
 public:
  static constexpr int kEdge = 3;  ///< [voxels]

  CoarseMap(const PlanningMap& map, const PathSearch& search);  ///< Keeps references to both.

  /// Lengths [m] of the shortest paths between all pairs of reached voxels. Where cells are too coarse to
  /// find a path, the length of the path by way of the robot's position.
  std::vector<std::vector<double>> Distances(const std::vector<VoxelIndex>& places);
  /// The same from one voxel to the others; infinite where the path over cells is longer than `within` [m].
  std::vector<double> DistancesFrom(const VoxelIndex& place, std::span<const VoxelIndex> others,
                                    double within = std::numeric_limits<double>::infinity()) {
    return DistancesFrom(place, others, within, state_);
  }
  /// The same from each of some voxels to the others, on all cores.
  std::vector<std::vector<double>> DistancesFromEach(std::span<const VoxelIndex> places,
                                                     std::span<const VoxelIndex> others) const;

  /// [m] Apart from how step costs are rounded (0.3 %), no path between two reached voxels is shorter than
  /// the straight line, nor than the difference of their paths from the robot.
  double LeastDistance(const VoxelIndex& a, const VoxelIndex& b) const;

  /// The value of the unknown space behind groups of unknown voxels: the value worth(voxels) of each dark
  /// region is divided among the groups that touch it, in proportion to how many of their voxels do.
  std::vector<double> WorthBehind(const std::vector<const std::vector<VoxelIndex>*>& groups,
                                  const std::function<double(double)>& worth) const;

  std::size_t known_voxels() const { return known_; }

 private:
  struct Step {
    std::uint32_t to;  ///< Offset of a cell,
    std::uint32_t by;  ///< and the bit of the neighbor that led to it.
  };
  static constexpr std::size_t kBuckets = 256;  ///< More than the most expensive step.
  struct FloodState {
    std::array<std::vector<Step>, kBuckets> buckets;  ///< Empty between floods.
    std::vector<std::uint32_t> costs;                 ///< [hundredths of a cell] The last flood's.
    std::vector<std::uint32_t> touched;               ///< Cells that the last flood reached.
  };

  double Straight(const VoxelIndex& a, const VoxelIndex& b) const;  ///< [m] Between the voxels' centers.
  std::size_t CellOf(const VoxelIndex& voxel) const;
  /// Describes the cells of one layer. @return  How many of its voxels are known.
  std::size_t Describe(int layer, const PlanningMap& map);
  void FindEdges();
  /// Computes the costs from a cell until those of all wanted cells, or all up to a limit, are known; greater
  /// ones are then unreliable.
  void Flood(std::size_t start, std::span<const std::size_t> wanted, std::uint32_t limit,
             FloodState& state) const;
  std::vector<double> DistancesFrom(const VoxelIndex& place, std::span<const VoxelIndex> others,
                                    double within, FloodState& state) const;
  void FindRegions();

  const PathSearch& search_;
  double voxel_size_;
  VoxelIndex origin_;
  VoxelBox cells_box_;
  DenseGrid<std::uint8_t> exits_;   ///< Whether a cell is open, and to which face neighbors.
  DenseGrid<std::uint32_t> edges_;  ///< Bits of the 26 neighbors to which there is a connection.
  FloodState state_;
  DenseGrid<std::uint8_t> unknown_;  ///< Number of unknown voxels in each cell.
  DenseGrid<std::int32_t> region_;   ///< -1 = not dark.
  std::vector<std::size_t> region_volume_;
  std::size_t known_ = 0;
};

}  // namespace thalweg::explorer
