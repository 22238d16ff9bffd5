#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "common/voxel/occupancy_grid.h"
#include "services/mapper/core/voxel_colors.h"

namespace thalweg::mapper {

/// Everything a mapper needs to resume where another one stopped: the exact log-odds and the colors.
struct Checkpoint {
  OccupancyGrid grid;
  VoxelColors colors;
};

/// Encodes a checkpoint in a format of its own rather than as .ot: OctoMap's reader trusts its input, and a
/// checkpoint is read after a crash.
///
/// Layout, little endian: "THALWEG1", number of bytes that follow (u64), their FNV-1a hash (u64); then voxel
/// size [m] (f64); number of blocks (u32), and for each its index (3 x i32) and 512 log-odds (f32); number of
/// color blocks (u32), and for each its index and 512 x (r, g, b, count) (u16).
std::string EncodeCheckpoint(const OccupancyGrid& grid, const VoxelColors& colors);
/// Error: whether the bytes are truncated, of another format or corrupt, and where.
Result<Checkpoint> DecodeCheckpoint(std::string_view bytes);

/// Loads the checkpoint in `file`, or nothing if there is no such file. Error: as DecodeCheckpoint, preceded
/// by the file's name.
Result<std::optional<Checkpoint>> LoadCheckpoint(const std::filesystem::path& file);

OccupancyGrid CopyOf(const OccupancyGrid& grid);

}  // namespace thalweg::mapper
