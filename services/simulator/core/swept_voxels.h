#pragma once

#include <cstdint>
#include <span>

#include "common/voxel/dense_grid.h"
#include "services/simulator/core/moving_part.h"

namespace thalweg::simulator {

/// Flags each voxel of a box that one of the parts meets at any time of its timetable, and at most those
/// besides that it misses by an eighth of a voxel.
DenseGrid<std::uint8_t> SweptVoxels(std::span<const MovingPart> parts, const VoxelBox& box,
                                    double voxel_size);

}  // namespace thalweg::simulator
