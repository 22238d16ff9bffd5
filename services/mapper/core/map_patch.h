#pragma once

#include <cstdint>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "common/voxel/occupancy_grid.h"
#include "services/mapper/core/voxel_colors.h"

namespace thalweg::mapper {

/// A voxel's new color.
struct ColorChange {
  VoxelIndex voxel;
  VoxelColors::Mean mean;
};

/// What is new in a map, as values rather than steps: what one cloud changed, or part of a whole map.
struct MapPatch {
  std::vector<VoxelChange> voxels;
  std::vector<ColorChange> colors;
};

/// Sets the patch's values in a map.
void Apply(const MapPatch& patch, OccupancyGrid& grid, VoxelColors& colors);

/// Largest patch that is coded, before compression. A cloud of 512 x 384 rays at 0.05 m takes up about 1 MB.
inline constexpr std::uint64_t kMostPatchBytes = 8U << 20U;

/// Codes a patch: which voxels of each block as bits; log-odds as indices into the values that occur, of
/// which a map has few; colors as differences, high bytes and low bytes apart; all of it compressed by zstd.
/// Values are kept bit by bit; of several for one voxel, the last.
/// Error: it takes up more than kMostPatchBytes.
Result<std::vector<std::uint8_t>> Encode(const MapPatch& patch);
/// The inverse. The bytes may be anybody's: sizes, indices and values are checked.
/// Error: why Encode does not make such bytes.
Result<MapPatch> DecodeMapPatch(Bytes bytes);

}  // namespace thalweg::mapper
