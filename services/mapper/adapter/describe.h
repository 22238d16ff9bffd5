#pragma once

#include <string>

#include "services/mapper/adapter/map_formats.h"
#include "services/mapper/core/map_operations.h"

namespace thalweg::mapper {

// Lines for people.

/// What a map holds: its format, voxels, volumes and bounds; the latter not if no voxel is known.
std::string Describe(const LoadedMap& loaded);

/// What a point cloud or a mesh holds, and what it lacks to be a map.
std::string Describe(const PlyFile& ply);

/// A table of the voxels by their state in both maps, and the share of those known to both that agree.
std::string Describe(const MapDifference& difference);

}  // namespace thalweg::mapper
