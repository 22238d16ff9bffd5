#pragma once

#include <cstdint>
#include <memory>

#include "common/geometry/point_cloud.h"

namespace thalweg::mapper {

/// Drops points of a cloud before it is fused. To add one, see docs/guide/own-parts.md.
/// Threading: one thread owns a filter. It may keep state between clouds.
class CloudFilter {
 public:
  virtual ~CloudFilter() = default;
  /// Sets the points that are to be dropped to NaN. The cloud's size, its colors and its rays without a
  /// return (IsNoReturn) stay as they are.
  virtual void Apply(PointCloud& cloud) = 0;
};

struct FilterOptions {
  enum class Type : std::uint8_t {
    kNone,
    kDistance,  ///< Drops points farther from the camera than max_distance.
    kVoxel,     ///< Keeps one point of each cell, the one nearest to the mean of the cell's points.
    /// Drops statistical outliers, as PCL's StatisticalOutlierRemoval does: points whose mean distance to
    /// their nearest neighbors exceeds the mean of all such distances by a multiple of their standard
    /// deviation.
    kOutlier,
  };
  Type type = Type::kNone;
  double max_distance = 10.0;  ///< [m] As the source thesis prints it.
  double cell = 0.05;          ///< [m] Edge of the cells, which are aligned to the camera's axes.
  int neighbors = 8;           ///< Without the point itself.
  double deviations = 2.0;     ///< That multiple.
};

/// Returns null for kNone. Throws std::invalid_argument naming the invalid option.
std::unique_ptr<CloudFilter> MakeFilter(const FilterOptions& options);

}  // namespace thalweg::mapper
