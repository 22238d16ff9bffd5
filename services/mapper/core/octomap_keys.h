#pragma once

#include <octomap/OcTreeKey.h>

#include "common/voxel/voxel_index.h"

namespace thalweg::mapper {

/// The key of a voxel in a tree of OctoMap, and back. Keys count from the grid's lowest corner.
inline octomap::OcTreeKey KeyOf(const VoxelIndex& i) {
  const auto key = [](std::int32_t v) { return static_cast<octomap::key_type>(v + kMaxVoxelIndex + 1); };
  return {key(i.x), key(i.y), key(i.z)};
}
inline VoxelIndex VoxelOf(const octomap::OcTreeKey& key) {
  const auto index = [](octomap::key_type k) { return static_cast<std::int32_t>(k) - kMaxVoxelIndex - 1; };
  return {index(key[0]), index(key[1]), index(key[2])};
}

}  // namespace thalweg::mapper
