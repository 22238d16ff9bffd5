#pragma once

#include <algorithm>
#include <cstdint>

namespace thalweg {

/// What is dropped of each cloud before it is fused.
struct FilterModel {
  enum class Type : std::uint8_t {
    kNone,
    kDistance,  ///< Points farther from the camera than max_distance.
    kVoxel,     ///< All but one point of each cell, the one nearest to the mean of the cell's points.
    /// Statistical outliers, as of PCL's StatisticalOutlierRemoval: points whose mean distance to their
    /// nearest neighbors exceeds the mean of all such distances by a multiple of their standard deviation.
    kOutlier,
  };
  Type type = Type::kNone;
  double max_distance = 10.0;  ///< [m] As the source thesis prints it.
  double cell = 0.05;          ///< [m] Edge of the cells, which are aligned to the camera's axes.
  int neighbors = 8;           ///< Without the point itself.
  double deviations = 2.0;     ///< The multiple of the standard deviation.
};

/// What several services must know of the mapper's map, each of which reads it from the scenario.
struct MapModel {
  double voxel_size = 0.10;  ///< [m]
  double max_range = 5.0;    ///< [m] Nothing farther from the sensor is mapped.
  FilterModel filter;

  /// [m] Farther from a sensor with that range nothing is mapped, nor cleared by points.
  double SeenRange(double sensor_range) const {
    const double range = std::min(max_range, sensor_range);
    return filter.type == FilterModel::Type::kDistance ? std::min(range, filter.max_distance) : range;
  }
};

}  // namespace thalweg
