#include "common/voxel/occupancy_grid.h"

#include <stdexcept>
#include <string>

#include "common/base/text.h"

namespace thalweg {

OccupancyGrid::OccupancyGrid(double voxel_size) : voxel_size_(voxel_size) {
  if (!std::isfinite(voxel_size) || voxel_size <= 0.0) {
    throw std::invalid_argument("voxel_size must be > 0 m, is " + NumberText(voxel_size));
  }
}

OccupancyGrid::Block& OccupancyGrid::BlockAt(const VoxelIndex& block) {
  std::unique_ptr<Block>& slot = blocks_[block];
  if (!slot) {
    slot = std::make_unique<Block>();
    slot->fill(kUnknown);
  }
  return *slot;
}

bool OccupancyGrid::SameAs(const OccupancyGrid& other) const {
  if (voxel_size_ != other.voxel_size_) return false;
  const auto covered_by = [](const OccupancyGrid& a, const OccupancyGrid& b) {
    bool same = true;
    a.ForEachKnown([&](const VoxelIndex& i, float log_odds) { same = same && b.LogOdds(i) == log_odds; });
    return same;
  };
  return covered_by(*this, other) && covered_by(other, *this);
}

}  // namespace thalweg
