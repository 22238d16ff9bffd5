#pragma once

#include <cstdint>

#include "services/explorer/core/path/path_search.h"

namespace thalweg::explorer {

/// When a planning map, or what can be reached in it, last changed in each block of 8 x 8 x 8 voxels. What
/// depends on the surroundings of a voxel alone need not be computed again while these stay the same.
/// Threading: one thread.
class ReachChanges {
 public:
  /// Compares with what was there the time before; everything beyond the map's box is unknown and not
  /// reached. Everything counts as changed when part of the box is no longer in it, as after a reset.
  /// O(voxels of the map's box), a fraction of what a flood takes.
  /// @param search  Flooded on this map.
  void Update(const PlanningMap& map, const PathSearch& search);

  /// The number of updates so far.
  std::uint32_t now() const { return now_; }
  /// The update that has found the last change in a box or near it; 0 = none has.
  std::uint32_t LastIn(const VoxelBox& box) const;

 private:
  /// The blocks that a box of voxels touches.
  static VoxelBox BlocksOf(const VoxelBox& box);

  DenseGrid<std::uint8_t> before_;  ///< State of each voxel, and whether it was reached.
  DenseGrid<std::uint32_t> last_;   ///< By block.
  std::uint32_t now_ = 0;
};

}  // namespace thalweg::explorer
