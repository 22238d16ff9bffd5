#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "common/geometry/point_cloud.h"

namespace thalweg::mapper {

/// What a PLY file holds: a point cloud, a mesh, or a map that we wrote.
struct PlyFile {
  std::vector<Eigen::Vector3d> points;                  ///< [m]
  std::vector<Rgb> colors;                              ///< One for each point, or none.
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Corners, among the points.
  /// [m] A map that we wrote states it. Its triangles are the outer sides of occupied voxels, its points
  /// without a triangle the middles of those that have occupied neighbors on all sides.
  std::optional<double> map_voxel_size;
};

/// The line of the header by which we know our own maps; their voxel size [m] follows.
inline constexpr std::string_view kPlyVoxelSize = "comment thalweg voxel_size ";

/// Color of voxels without one.
inline constexpr Rgb kPlyNoColor{160, 160, 160};

/// Decodes a PLY file, ascii or binary in either byte order, with any elements and properties [Turk: The PLY
/// Polygon File Format, 1994]. Reads x, y and z of its vertices; red, green and blue where it has all three,
/// 0 to 255 as integers, else 0 to 1; and its faces, polygons as fans of triangles. Points of a cloud with a
/// NaN are left out.
/// Takes memory in proportion to the bytes, whatever the header claims. No library of Debian 12 does: assimp
/// 5.2 writes beyond its memory for a header with two vertex elements, does not end for one without an end,
/// invents the vertices that a file cut off lacks, and misreads vertices after other elements.
/// Error: what is wrong, and at which vertex or face.
Result<PlyFile> DecodePly(Bytes bytes);

/// Whether the bytes begin as such a file.
bool IsPly(Bytes bytes);

}  // namespace thalweg::mapper
