#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// Finds the positions from which candidates are visible.
///
/// A position sees enough of a candidate if at least three quarters of the samples of its cluster that are
/// visible from the candidate's first goal are visible from there, too. To find such positions, rays are cast
/// from the cluster through free space; of the voxels that they cross, the cheapest in each cell of 3 x 3 x 3
/// voxels is tried.
/// Threading: one thread.
class Viewpoints {
 public:
  explicit Viewpoints(const Situation& situation);  ///< Keeps a reference to the situation.

  bool SeesEnough(const VoxelIndex& from, std::size_t candidate);

  /// Reached voxels that are crossed by rays from the samples of a candidate's cluster. May repeat voxels.
  std::vector<VoxelIndex> PlacesBefore(std::size_t candidate);
  /// The cost of a position; kUnreached excludes it.
  using Cost = std::function<std::uint32_t(const VoxelIndex&)>;
  /// Positions that see enough of a candidate: its first goal and the cheapest ones from `before`, which
  /// PlacesBefore returns.
  std::vector<VoxelIndex> PlacesFor(std::size_t candidate, const std::vector<VoxelIndex>& before,
                                    const Cost& cost_of);

 private:
  bool Sees(const VoxelIndex& from, const VoxelIndex& unknown) const;
  /// The samples of a candidate's cluster that are visible from its first goal.
  const std::vector<VoxelIndex>& WantedOf(std::size_t candidate);

  const Situation& situation_;
  std::vector<std::optional<std::vector<VoxelIndex>>> wanted_;  ///< For each candidate, once computed.
  std::vector<std::vector<RayStep>> rays_;
};

}  // namespace thalweg::explorer
