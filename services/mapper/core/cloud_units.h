#pragma once

#include "common/geometry/point_cloud.h"

namespace thalweg::mapper {

/// [m] Beyond this distance, twenty times that up to which points are mapped, hardly any point of a cloud in
/// meters lies.
constexpr double FarthestPlausible(double max_range) {
  return 20.0 * max_range;
}

/// Whether a cloud can hardly be in meters: nine in ten of its measured points lie beyond FarthestPlausible.
/// A cloud in millimeters is like that, and would empty the whole map.
/// @param max_range  [m] up to which points are mapped.
bool IsOfOtherUnits(const PointCloud& cloud, double max_range);

}  // namespace thalweg::mapper
