#pragma once

#include <cstdint>
#include <memory>

#include "services/mapper/core/fused_map.h"
#include "services/mapper/core/occupancy_map.h"

namespace thalweg::mapper {

/// What a map is fused by.
enum class MapEngine : std::uint8_t {
  kBlocks,   ///< OccupancyMap: hashed blocks, and rules beyond OctoMap.
  kOctomap,  ///< OctreeMap: octomap::OcTree.
};

/// To add one, see docs/guide/own-parts.md. Throws std::invalid_argument naming the bad option.
std::unique_ptr<FusedMap> MakeMap(MapEngine engine, const OccupancyMap::Options& options);
/// Resumes from a map of the same voxel size, whichever engine fused it.
std::unique_ptr<FusedMap> MakeMap(MapEngine engine, const OccupancyMap::Options& options, OccupancyGrid map);

}  // namespace thalweg::mapper
