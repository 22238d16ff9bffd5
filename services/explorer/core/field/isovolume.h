#pragma once

#include <cstdint>
#include <vector>

#include "common/voxel/dense_grid.h"
#include "services/explorer/core/field/harmonic_field.h"

namespace thalweg::explorer {

/// The isovolume of a seed, Algorithm 4 of the source thesis [Shade: Choosing Where To Go, DPhil thesis,
/// Oxford 2011, Ch. 6]: all cells that steps from face to face connect with the seed without rising above its
/// phi; none if a sink is among them. The thesis leaves such cells out of later solves, since nothing is to
/// be found downhill from there.
///
/// In the exact field there are none, but where no sink can be reached at all: a free cell's phi is a mean of
/// its neighbors', so that from each cell some path that never rises leads to a sink (minimum principle).
/// What the algorithm finds it owes to sweeps that have not arrived, where phi is still near its start of 0,
/// or, on the plateau of a dead end, to their last digits. SealedField seals by another rule: what the flux
/// through its rim says.
/// @param phi  Over the box of the cells; NaN in walls.
/// @return     In no order; empty if there is no isovolume.
std::vector<VoxelIndex> FindIsovolume(const DenseGrid<FieldCell>& cells, const DenseGrid<double>& phi,
                                      const VoxelIndex& seed);

/// Nonzero for each cell that belongs to the isovolume of some seed. A cell does exactly if its own isovolume
/// exists, so that one pass over the cells in the order of phi finds all. The thesis does not print which
/// seeds it takes: this is what all of them find together.
DenseGrid<std::uint8_t> AllIsovolumes(const DenseGrid<FieldCell>& cells, const DenseGrid<double>& phi);

}  // namespace thalweg::explorer
