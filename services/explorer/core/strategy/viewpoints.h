#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// From where candidates are seen.
///
/// A place sees enough of a candidate when nearly as much of its cluster is in plain sight from there as from
/// its first goal, the place nearest to the cluster. Rays leave the cluster through free space; what they
/// cross are places to try, of each cell of 3 x 3 x 3 voxels the cheapest.
/// Threading: one thread.
class Viewpoints {
 public:
  explicit Viewpoints(const Situation& situation);  ///< Keeps the situation by reference.

  bool SeesEnough(const VoxelIndex& from, std::size_t candidate);

  /// Places in the robot's reach that are crossed by rays from what is wanted of a candidate.
  std::vector<VoxelIndex> PlacesBefore(std::size_t candidate);
  /// Of a place; kUnreached rules it out.
  using Cost = std::function<std::uint32_t(const VoxelIndex&)>;
  /// Places that see enough of a candidate: its first goal and, of those before it, the cheapest ones.
  std::vector<VoxelIndex> PlacesFor(std::size_t candidate, const std::vector<VoxelIndex>& before,
                                    const Cost& cost_of);

 private:
  bool Sees(const VoxelIndex& from, const VoxelIndex& unknown) const;
  /// Samples of a candidate's cluster that are seen from its first goal.
  const std::vector<VoxelIndex>& WantedOf(std::size_t candidate);

  const Situation& situation_;
  std::vector<std::optional<std::vector<VoxelIndex>>> wanted_;  ///< Of each candidate, once it was asked for.
  std::vector<std::vector<RayStep>> rays_;
};

}  // namespace thalweg::explorer
