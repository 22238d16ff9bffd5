#pragma once

#include <vector>

#include "common/voxel/dense_grid.h"
#include "services/evaluator/core/place_graph.h"

namespace thalweg::evaluator {

/// Places spread over a set of voxels, and the paths between them.
///
/// The places are the voxels of a lattice and, where the set is narrow, more of them, so that each voxel has
/// a place near it. Two places at most two steps of the lattice apart along each axis are linked when the
/// straight segment between their centers stays inside the set; segments along which another place of the
/// lattice lies are left out, since the path leads through it. In open space a path is therefore up to 5 %
/// longer than the straight line. Where the set is connected but no segment is inside it, places are linked
/// through the voxels between them.
struct ViewLattice {
  std::vector<VoxelIndex> places;
  PlaceGraph graph;         ///< Links the places.
  int step = 0;             ///< [voxels] between places of the lattice.
  double voxel_size = 0.0;  ///< [m]

  /// Adds a place at the center of a voxel of the set, linked like the others. @return Its index: that of the
  /// place that is there already, if there is one.
  std::size_t Add(const DenseGrid<std::uint8_t>& set, const VoxelIndex& voxel);
};

/// @param set       Flags; the voxels are connected over their faces.
/// @param min_step  Least step of the lattice [voxels], at least 1.
/// @param most      No more places: with more, the step is larger. 0 = any number.
ViewLattice LatticeOn(const DenseGrid<std::uint8_t>& set, double voxel_size, int min_step, std::size_t most);

}  // namespace thalweg::evaluator
