#include "services/cli/report/coverage_tally.h"

namespace thalweg::cli {

void CoverageTally::Add(const VoxelIndex& voxel) {
  const VoxelIndex block = OccupancyGrid::BlockOf(voxel);
  auto known = known_.find(block);
  if (known == known_.end()) {
    if (known_.size() >= most_blocks_) {
      full_ = true;
      return;
    }
    known = known_.emplace(block, Known()).first;
  }
  auto bit = known->second[OccupancyGrid::OffsetInBlock(voxel)];
  if (bit) return;
  if (order_.size() >= most_voxels_) {
    full_ = true;
    return;
  }
  bit = true;
  order_.push_back(voxel);
}

void CoverageTally::Add(const OccupancyGrid& grid) {
  grid.ForEachKnown([this](const VoxelIndex& voxel, float) { Add(voxel); });
}

void CoverageTally::Sample(const ProgressSample& now, double voxel_volume) {
  ProgressSample sample = now;
  sample.explored = static_cast<double>(known()) * voxel_volume;
  samples_.push_back(sample);
  known_at_.push_back(known());
}

std::vector<ProgressSample> CoverageTally::SamplesWith(
    const std::function<bool(const VoxelIndex&)>& observable, std::size_t count) const {
  std::vector<ProgressSample> samples = samples_;
  std::size_t seen = 0;
  std::size_t next = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (; next < known_at_[i]; ++next) seen += observable(order_[next]) ? 1 : 0;
    if (count > 0) samples[i].coverage = static_cast<double>(seen) / static_cast<double>(count);
  }
  return samples;
}

}  // namespace thalweg::cli
