#include "services/controller/core/path_check.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/interval.h"
#include "common/voxel/for_each_voxel.h"
#include "common/voxel/voxels_within.h"

namespace thalweg::controller {
namespace {

/// [m] A body that only meets a voxel's face does not touch it; a plan that says so may be rounded.
constexpr double kTouch = 1e-5;

VoxelBox VoxelsOf(const VoxelIndex& block) {
  constexpr int kEdge = OccupancyGrid::kBlockEdge;
  const VoxelIndex first{block.x * kEdge, block.y * kEdge, block.z * kEdge};
  return {first, first + VoxelIndex{kEdge, kEdge, kEdge}};
}

}  // namespace

template <class Visitor>
std::size_t PathCheck::ForEachTouched(const OccupancyGrid& map, const Eigen::Vector3d& p_W,
                                      Visitor&& visit) const {
  const double size = map.voxel_size();
  const bool cylinder = body_.height > 0.0;
  const double up = cylinder ? 0.5 * body_.height : body_.radius;
  const Eigen::Vector3d extent(body_.radius, body_.radius, up);
  const VoxelBox box = VoxelsWithin({p_W - extent, p_W + extent}, size);
  const auto touches = [&](const VoxelIndex& i) {
    const auto along = [size](double p, int k) { return DistanceToInterval(p, k * size, (k + 1) * size); };
    const double aside = std::hypot(along(p_W.x(), i.x), along(p_W.y(), i.y));
    const double above = along(p_W.z(), i.z);
    if (body_.drives && std::abs((i.z + 0.5) * size - p_W.z()) >= up) return false;
    if (cylinder) return aside < body_.radius - kTouch && above < up - kTouch;
    return std::hypot(aside, above) < body_.radius - kTouch;
  };
  std::size_t looked_at = 0;
  const VoxelBox blocks{OccupancyGrid::BlockOf(box.min),
                        OccupancyGrid::BlockOf(box.max - VoxelIndex{1, 1, 1}) + VoxelIndex{1, 1, 1}};
  ForEachVoxel(blocks, [&](const VoxelIndex& block_index) {
    ++looked_at;
    const OccupancyGrid::Block* const block = map.FindBlock(block_index);
    if (block == nullptr) return true;
    return ForEachVoxel(Intersection(box, VoxelsOf(block_index)), [&](const VoxelIndex& i) {
      ++looked_at;
      const float log_odds = (*block)[OccupancyGrid::OffsetInBlock(i)];
      if (OccupancyGrid::StateOf(log_odds) != VoxelState::kOccupied || !touches(i)) return true;
      return visit(i);
    });
  });
  return looked_at;
}

void PathCheck::Restart(const OccupancyGrid& map, const Track& track, double s) {
  clear_to_ = s;
  obstacle_W_.reset();
  touched_at_start_.clear();
  ForEachTouched(map, track.PositionAt(s), [&](const VoxelIndex& i) {
    touched_at_start_.insert(i);
    return true;
  });
}

void PathCheck::Continue(const OccupancyGrid& map, const Track& track) {
  std::size_t looked_at = 0;
  while (!obstacle_W_ && clear_to_ < track.length() && looked_at < kBudget) {
    const double next = std::min(track.length(), clear_to_ + 0.25 * map.voxel_size());
    looked_at += ForEachTouched(map, track.PositionAt(next), [&](const VoxelIndex& i) {
      if (touched_at_start_.contains(i)) return true;
      obstacle_W_ = map.CenterOf(i);
      return false;
    });
    if (!obstacle_W_) clear_to_ = next;
  }
}

}  // namespace thalweg::controller
