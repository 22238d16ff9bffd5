#include "services/link/core/map_feed.h"

#include <bit>
#include <cmath>
#include <utility>

#include "common/base/check.h"

namespace thalweg::link {
namespace {

bool Same(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) ||
         (std::isnan(a) && std::isnan(b));
}

}  // namespace

void MapFeed::Queue(const VoxelIndex& block) {
  if (queued_.insert(block).second) queue_.push_back(block);
}

void MapFeed::Note(Time stamp, std::span<const VoxelChange> changes, std::span<const ScanView> scans) {
  stamp_ = stamp;
  for (const VoxelChange& change : changes) Queue(OccupancyGrid::BlockOf(change.voxel));
  for (const ScanView& scan : scans) scans_.push_back(scan);
  for (; scans_.size() > kMostScans; ++dropped_scans_) scans_.pop_front();
}

void MapFeed::Restart(Time stamp, const OccupancyGrid& grid) {
  THALWEG_CHECK(grid.voxel_size() == sent_.voxel_size());
  stamp_ = stamp;
  reset_ = true;
  sent_.Clear();
  queue_.clear();
  queued_.clear();
  grid.ForEachBlock([&](const VoxelIndex& index, const OccupancyGrid::Block&) { Queue(index); });
}

bool MapFeed::AddBlock(const OccupancyGrid& grid, const VoxelIndex& index, MapChange& change) {
  const OccupancyGrid::Block* const block = grid.FindBlock(index);
  if (block == nullptr) return false;
  OccupancyGrid::Block& sent = sent_.BlockAt(index);
  bool differs = false;
  for (std::size_t k = 0; k < block->size(); ++k) {
    if (Same((*block)[k], sent[k])) continue;
    differs = true;
    sent[k] = (*block)[k];
    change.voxels.push_back({OccupancyGrid::IndexInBlock(index, k), sent[k]});
  }
  return differs;
}

std::optional<MapChange> MapFeed::Next(const OccupancyGrid& grid) {
  if (queue_.empty() && scans_.empty() && !reset_) return std::nullopt;
  MapChange change{.reset = std::exchange(reset_, false),
                   .stamp = stamp_,
                   .voxel_size = sent_.voxel_size(),
                   .scans = {scans_.begin(), scans_.end()},
                   .voxels = {}};
  scans_.clear();
  for (std::size_t blocks = 0; blocks < kBlocks && !queue_.empty(); queue_.pop_front()) {
    queued_.erase(queue_.front());
    if (AddBlock(grid, queue_.front(), change)) ++blocks;
  }
  return change;
}

}  // namespace thalweg::link
