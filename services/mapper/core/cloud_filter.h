#pragma once

#include <memory>

#include "common/geometry/map_model.h"
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

/// Returns null for kNone. Throws std::invalid_argument naming the invalid option.
std::unique_ptr<CloudFilter> MakeFilter(const FilterModel& model);

}  // namespace thalweg::mapper
