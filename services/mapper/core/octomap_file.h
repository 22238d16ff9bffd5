#pragma once

#include <cstddef>

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "common/voxel/occupancy_grid.h"
#include "services/mapper/core/voxel_colors.h"

namespace thalweg::mapper {

/// Log-odds of the voxels of a `.bt` file, which only says free or occupied: OctoMap's limits, as its own
/// reader has them.
inline constexpr float kFreeOfBt = -2.0F;
inline constexpr float kOccupiedOfBt = 3.5F;

struct ColoredMap {
  OccupancyGrid grid;
  VoxelColors colors;
};

/// Decodes a file of OctoMap: `.ot` with trees of type OcTree or ColorOcTree, or `.bt` [Hornung et al.:
/// OctoMap, Autonomous Robots 34(3), 2013, Sec. 4.4; layout of OctoMap 1.9]. Leaves above the lowest level,
/// which pruning leaves behind, become all of their voxels; what follows the tree is ignored.
/// OctoMap's own reader trusts its input; this one reads files of strangers.
/// @param most_blocks  Most blocks of the grid; a small file can list leaves that would take up gigabytes.
/// Error: what is wrong, and at which byte.
Result<ColoredMap> DecodeOctomap(Bytes bytes, std::size_t most_blocks);

/// Whether the bytes begin as such a file.
bool IsOctomap(Bytes bytes);

}  // namespace thalweg::mapper
