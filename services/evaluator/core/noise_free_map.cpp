#include "services/evaluator/core/noise_free_map.h"

#include <algorithm>
#include <utility>

#include "common/voxel/voxels_within.h"

namespace thalweg::evaluator {
namespace {

DepthSensorModel WithoutNoise(DepthSensorModel sensor) {
  sensor.disparity_noise_px = 0.0;
  sensor.image_noise_px = 0.0;
  return sensor;
}

}  // namespace

NoiseFreeMap::NoiseFreeMap(const simulator::World& world, DepthSensorModel sensor,
                           std::unique_ptr<mapper::CloudFilter> filter, std::unique_ptr<mapper::FusedMap> map)
    : world_(world),
      sensor_(WithoutNoise(sensor), /*noise_seed=*/1, /*colors=*/false),
      filter_(std::move(filter)),
      map_(std::move(map)) {}

void NoiseFreeMap::OnScan(const RigidTransform& T_WC) {
  PointCloud cloud = sensor_.Capture(world_, T_WC);
  if (filter_) filter_->Apply(cloud);
  map_->Integrate(cloud, T_WC);
}

double NoiseFreeMap::Likeness(const OccupancyGrid& map) const {
  const OccupancyGrid exact = map_->Snapshot();
  const VoxelBox box = VoxelsWithin(world_.bounds(), exact.voxel_size());
  std::size_t unlike = 0;
  exact.ForEachKnown([&](const VoxelIndex& i, float log_odds) {
    if (box.Contains(i) && map.State(i) != OccupancyGrid::StateOf(log_odds)) ++unlike;
  });
  map.ForEachKnown([&](const VoxelIndex& i, float) {
    if (box.Contains(i) && exact.State(i) == VoxelState::kUnknown) ++unlike;
  });
  const std::size_t all = std::max<std::size_t>(1, box.count());
  return static_cast<double>(all - unlike) / static_cast<double>(all);
}

}  // namespace thalweg::evaluator
