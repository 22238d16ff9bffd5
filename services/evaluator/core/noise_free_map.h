#pragma once

#include <memory>

#include "common/geometry/rigid_transform.h"
#include "services/mapper/core/cloud_filter.h"
#include "services/mapper/core/fused_map.h"
#include "services/simulator/core/depth_sensor.h"
#include "services/simulator/core/world.h"

namespace thalweg::evaluator {

/// The map that a depth sensor without noise would have made of the scans of a run.
class NoiseFreeMap {
 public:
  /// @param world   Must outlive the object.
  /// @param sensor  Its noise is left out.
  /// @param filter  The filter of the run; null if nothing is dropped.
  /// @param map     Empty.
  NoiseFreeMap(const simulator::World& world, DepthSensorModel sensor,
               std::unique_ptr<mapper::CloudFilter> filter, std::unique_ptr<mapper::FusedMap> map);

  /// @param T_WC  The true pose of a scan.
  void OnScan(const RigidTransform& T_WC);

  /// Compares with the map of the run. @return Share of all voxels of the world's box that are unknown, free
  /// or occupied in both: what the source thesis calls accuracy [Shade: Choosing Where To Go, DPhil thesis,
  /// Oxford 2011, 6.5.3].
  double Likeness(const OccupancyGrid& map) const;

 private:
  const simulator::World& world_;
  simulator::DepthSensor sensor_;
  std::unique_ptr<mapper::CloudFilter> filter_;
  std::unique_ptr<mapper::FusedMap> map_;
};

}  // namespace thalweg::evaluator
