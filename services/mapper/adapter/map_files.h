#pragma once

#include <octomap/OcTree.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/dds/convert.h"
#include "common/dds/topics.h"
#include "common/voxel/occupancy_grid.h"
#include "services/mapper/core/voxel_colors.h"

namespace thalweg::mapper {

/// Converts the map to an OctoMap tree with exactly the same log-odds, pruned. O(n log n); 0.1 to 1 s for a
/// large map.
std::unique_ptr<octomap::OcTree> ToOcTree(const OccupancyGrid& grid);

/// Encode the contents of `.ot` files (log-odds) and `.bt` files (free or occupied; octovis and bt2vrml read
/// them).
/// @param tree  EncodeBt reduces its values to free and occupied.
std::string EncodeOt(const octomap::OcTree& tree);
std::string EncodeBt(octomap::OcTree& tree);

/// Encodes the occupied voxels as colored cubes without their inner faces, as binary little-endian PLY.
/// Voxels without a color are gray. Those without a face are vertices in their middles, and the header states
/// the voxel size, so that DecodePly gets back each of them.
std::string EncodePly(const OccupancyGrid& grid, const VoxelColors& colors);

/// Writes map.bt, map.ot and map.ply into `folder`, each even if another one cannot be written. Throws
/// std::runtime_error naming file and reason of each that was not written.
void SaveMap(const OccupancyGrid& grid, const VoxelColors& colors, const std::filesystem::path& folder);

/// Converts as octomap_msgs::fullMapToMsg does, so that octomap_msgs::fullMsgToMap and rviz can read the
/// result.
octomap_msgs::msg::Octomap ToIdl(Time stamp, const octomap::OcTree& tree);

/// The centers of the occupied voxels, colored by height.
std::vector<dds::ColoredPoint> OccupiedPoints(const OccupancyGrid& grid);

/// The centers of the occupied voxels that have a color, in it.
std::vector<dds::ColoredPoint> ColoredPoints(const OccupancyGrid& grid, const VoxelColors& colors);

}  // namespace thalweg::mapper
