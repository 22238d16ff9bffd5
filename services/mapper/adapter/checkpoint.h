#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "common/voxel/occupancy_grid.h"
#include "services/mapper/core/voxel_colors.h"

namespace thalweg::mapper {

/// All that a mapper needs to go on where another ended: log-odds bit by bit, and colours.
struct Checkpoint {
  OccupancyGrid grid;
  VoxelColors colors;
};

/// A format of our own and not .ot: OctoMap's reader trusts what it reads, and this one is read after a
/// crash. Little endian: "THALWEG1", bytes that follow (u64), their FNV-1a hash (u64); then the voxel size
/// (f64); the number of blocks (u32) and each block's index (3 x i32) and 512 log-odds (f32); the number of
/// colour blocks (u32) and each one's index and 512 x (r, g, b, count) (u16).
std::string EncodeCheckpoint(const OccupancyGrid& grid, const VoxelColors& colors);
/// Error: truncated, foreign or garbled, and in what way.
Result<Checkpoint> DecodeCheckpoint(std::string_view bytes);

/// The checkpoint in `file`; nothing when there is no such file. Error: as DecodeCheckpoint, with its name.
Result<std::optional<Checkpoint>> LoadCheckpoint(const std::filesystem::path& file);

/// An independent copy.
OccupancyGrid CopyOf(const OccupancyGrid& grid);

}  // namespace thalweg::mapper
