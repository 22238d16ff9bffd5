#pragma once

#include <cstddef>

#include "common/base/result.h"
#include "services/mapper/core/octomap_file.h"
#include "services/mapper/core/ply_file.h"

namespace thalweg::mapper {

/// The map that a PLY file shows. Of a map that we wrote, exactly its occupied voxels and their colors. Of
/// others, a voxel is occupied where a point lies in it or a triangle passes through it, with the mean color
/// of its points, else that of the first triangle's corners. Free space is in no such file. Occupied voxels
/// have the log-odds of those of a `.bt`.
/// @param voxel_size   [m] > 0; of a map that we wrote, its own.
/// @param most_blocks  Most blocks of the grid; few triangles can take up gigabytes.
/// Error: which point lies beyond the grid, or that there are too many blocks.
Result<ColoredMap> MapOf(const PlyFile& file, double voxel_size, std::size_t most_blocks);

}  // namespace thalweg::mapper
