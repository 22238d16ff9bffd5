#pragma once

#include <vector>

#include "common/base/time.h"
#include "common/geometry/scan_view.h"
#include "common/voxel/occupancy_grid.h"
#include "services/link/core/packing.h"

namespace thalweg::link {

/// What has changed in a map, for the copy on the other side.
struct MapChange {
  bool reset = false;       ///< The copy starts over: what is not in `voxels` is unknown.
  Time stamp{};             ///< Stamp of the newest cloud in the map.
  double voxel_size = 0.0;  ///< [m]
  std::vector<ScanView> scans;
  std::vector<VoxelChange> voxels;  ///< Those of a block one after the other, each block once.
};

/// Codes a change: which voxels of a block as bits, their values as indices into those that occur, of which
/// a map has few; all of it packed. Values cross bit by bit.
Buffer Encode(const MapChange& change);
/// Error: bytes that Encode does not make: sizes, indices and values are checked.
Result<MapChange> DecodeMapChange(Bytes bytes);

}  // namespace thalweg::link
