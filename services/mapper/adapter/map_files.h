#pragma once

#include <octomap/OcTree.h>

#include <filesystem>
#include <memory>
#include <string>

#include "common/base/time.h"
#include "common/dds/topics.h"
#include "common/voxel/occupancy_grid.h"
#include "services/mapper/core/voxel_colors.h"

namespace thalweg::mapper {

/// The map as OctoMap holds it, log-odds bit by bit, pruned. O(n log n); 0.1 to 1 s for a large map.
std::unique_ptr<octomap::OcTree> ToOcTree(const OccupancyGrid& grid);

/// The contents of files: `.ot` (the log-odds), `.bt` (free or occupied; octovis and bt2vrml read it).
/// @param tree  EncodeBt reduces it to free and occupied.
std::string EncodeOt(const octomap::OcTree& tree);
std::string EncodeBt(octomap::OcTree& tree);

/// The occupied voxels as coloured cubes without their inner faces, binary little-endian PLY. Voxels without
/// a colour are grey.
std::string EncodePly(const OccupancyGrid& grid, const VoxelColors& colors);

/// Writes map.ot, map.bt and map.ply. Throws std::runtime_error naming file and reason.
void SaveMap(const OccupancyGrid& grid, const VoxelColors& colors, const std::filesystem::path& folder);

/// As octomap_msgs::fullMapToMsg does it, so that octomap_msgs::fullMsgToMap and rviz read it.
octomap_msgs::msg::Octomap ToIdl(Time stamp, const octomap::OcTree& tree);

}  // namespace thalweg::mapper
