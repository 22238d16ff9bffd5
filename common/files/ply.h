#pragma once

#include <string>

#include "common/geometry/point_cloud.h"

namespace thalweg {

/// The lines of a PLY's header for a color of three bytes.
inline constexpr auto kPlyColors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";

/// The finite points of a cloud as a binary little-endian PLY with x, y and z as float32 [m] and, if the
/// cloud has colors, red, green and blue as uint8, as MeshLab and CloudCompare read it.
std::string PlyOf(const PointCloud& cloud);

}  // namespace thalweg
