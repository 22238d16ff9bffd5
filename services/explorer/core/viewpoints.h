#pragma once

#include <cstdint>
#include <vector>

#include "services/explorer/core/strategy.h"

namespace thalweg::explorer {

/// From where a cluster is seen with the least travel: places that stand back from it.
///
/// Rays leave the cluster through free space; of the places in reach that they cross, the one nearest to the
/// robot is taken from which nearly as much of the cluster is in plain sight as from its first goal, the
/// place nearest to the cluster. Where rays miss such a place, one on the shortest way to the goal is.
/// Threading: one thread.
class Viewpoints {
 public:
  explicit Viewpoints(const Situation& situation);  ///< Keeps the situation by reference.
  VoxelIndex Nearest(const Candidate& candidate);

 private:
  struct Cell {
    std::uint32_t round = 0;  ///< Of the candidate in which it was last crossed.
    std::uint32_t cost = 0;   ///< Of its cheapest place that was crossed then.
    VoxelIndex place;
  };
  bool Sees(const VoxelIndex& from, const VoxelIndex& unknown) const;

  const Situation& situation_;
  std::vector<std::vector<RayStep>> rays_;
  DenseGrid<Cell> cells_;  ///< Of kEdge^3 voxels.
  std::uint32_t round_ = 0;
};

}  // namespace thalweg::explorer
