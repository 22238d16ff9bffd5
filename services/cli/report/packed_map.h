#pragma once

#include <cstdint>
#include <vector>

#include "common/voxel/occupancy_grid.h"
#include "services/cli/report/coverage_tally.h"

namespace thalweg::cli {

/// The occupied voxels of a map with the time at which each became known, small enough for a page.
struct PackedMap {
  /// [m] Edge of its voxels; that of the map times a power of two.
  double voxel_size = 0.0;
  std::size_t blocks = 0;    ///< Blocks of 8^3 voxels that hold an occupied one.
  std::size_t occupied = 0;  ///< Voxels.
  std::size_t left_out = 0;  ///< Occupied voxels of the map that lie too far away to be drawn.
  /// For each block its index x, y, z (int16, little-endian); then for each block 64 octets with a bit for
  /// each voxel, x fastest, lowest bit first; then for each occupied voxel, in that order, an octet: when it
  /// became known, from 0 at the start to 255 at the end of the run.
  std::vector<std::uint8_t> bytes;
};

/// Indices of blocks that a viewer takes: [-kFarthestBlock, kFarthestBlock).
inline constexpr std::int32_t kFarthestBlock = 8000;

/// Packs the map; with `halvings` > 0, voxels of 2^halvings the edge, occupied where any part is.
/// @param tally     When voxels became known; its order is that of the run.
/// @param duration  [s] Duration of the run.
PackedMap Pack(const OccupancyGrid& grid, const CoverageTally& tally, double duration, int halvings);

}  // namespace thalweg::cli
