#pragma once

#include <memory>
#include <span>
#include <utility>

#include "common/base/check.h"
#include "services/mapper/core/cloud_filter.h"
#include "services/mapper/core/fused_map.h"

namespace thalweg::mapper {

/// A map that fuses what a filter leaves of each cloud.
class FilteredMap final : public FusedMap {
 public:
  FilteredMap(std::unique_ptr<CloudFilter> filter, std::unique_ptr<FusedMap> map)
      : filter_(std::move(filter)), map_(std::move(map)) {
    THALWEG_CHECK(filter_ != nullptr && map_ != nullptr);
  }

  std::span<const VoxelChange> Integrate(const PointCloud& cloud, const RigidTransform& T_WC) override {
    left_ = cloud;
    filter_->Apply(left_);
    return map_->Integrate(left_, T_WC);
  }
  std::span<const Hit> hits() const override { return map_->hits(); }
  bool empty() const override { return map_->empty(); }
  OccupancyGrid Snapshot() const override { return map_->Snapshot(); }

 private:
  std::unique_ptr<CloudFilter> filter_;
  std::unique_ptr<FusedMap> map_;
  PointCloud left_;  ///< A member, so that its memory is allocated once.
};

}  // namespace thalweg::mapper
