#pragma once

#include "common/geometry/point_cloud.h"

namespace thalweg::mapper {

/// Whether a cloud can hardly be in meters: nine in ten of its measured points lie more than twenty times as
/// far away as the farthest that are mapped. A cloud in millimeters is like that, and would empty the whole
/// map.
/// @param max_range  [m] up to which points are mapped.
bool IsOfOtherUnits(const PointCloud& cloud, double max_range);

}  // namespace thalweg::mapper
