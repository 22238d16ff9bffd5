#include "common/dds/map_log.h"

#include <algorithm>
#include <bitset>
#include <chrono>
#include <cmath>
#include <utility>

#include "common/base/check.h"
#include "common/dds/convert.h"

namespace thalweg::dds {
namespace {

using Mask = std::bitset<OccupancyGrid::kBlockVoxels>;

thalweg_msgs::msg::MapBlock MakeBlock(const VoxelIndex& index, const Mask& mask,
                                      const OccupancyGrid::Block& values) {
  thalweg_msgs::msg::MapBlock block;
  block.x(index.x);
  block.y(index.y);
  block.z(index.z);
  block.mask().fill(0);
  block.log_odds().reserve(mask.count());
  for (std::size_t k = 0; k < mask.size(); ++k) {
    if (!mask[k]) continue;
    block.mask()[k / 8] = static_cast<std::uint8_t>(block.mask()[k / 8] | (1U << (k % 8)));
    block.log_odds().push_back(values[k]);
  }
  return block;
}

struct ChangedBlock {
  VoxelIndex index;
  Mask mask;
  OccupancyGrid::Block values;
};

}  // namespace

std::vector<thalweg_msgs::msg::MapBlock> BlocksOf(std::span<const VoxelChange> changes) {
  std::vector<ChangedBlock> changed;
  std::unordered_map<VoxelIndex, std::size_t, VoxelIndexHash> slots;
  std::size_t slot = 0;
  for (const VoxelChange& change : changes) {
    const VoxelIndex index = OccupancyGrid::BlockOf(change.voxel);
    if (changed.empty() || changed[slot].index != index) {
      // neighboring voxels mostly come one after the other
      slot = slots.try_emplace(index, changed.size()).first->second;
      if (slot == changed.size()) changed.push_back({.index = index, .mask = {}, .values = {}});
    }
    const std::size_t k = OccupancyGrid::OffsetInBlock(change.voxel);
    changed[slot].mask.set(k);
    changed[slot].values[k] = change.log_odds;
  }
  std::vector<thalweg_msgs::msg::MapBlock> blocks;
  blocks.reserve(changed.size());
  for (const ChangedBlock& block : changed)
    blocks.push_back(MakeBlock(block.index, block.mask, block.values));
  return blocks;
}

std::vector<thalweg_msgs::msg::MapBlock> BlocksOf(const OccupancyGrid& grid) {
  std::vector<thalweg_msgs::msg::MapBlock> blocks;
  blocks.reserve(grid.block_count());
  grid.ForEachBlock([&](const VoxelIndex& index, const OccupancyGrid::Block& values) {
    Mask mask;
    for (std::size_t k = 0; k < values.size(); ++k) mask.set(k, !std::isnan(values[k]));
    if (mask.any()) blocks.push_back(MakeBlock(index, mask, values));
  });
  return blocks;
}

MapLog::MapLog(std::uint64_t session, double voxel_size) : session_(session), voxel_size_(voxel_size) {
  THALWEG_CHECK(session != 0);
}

std::uint64_t MapLog::MakeSession() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::max<Duration::rep>(1, Duration(now).count()));
}

void MapLog::Add(Time stamp, const ScanView& scan, std::span<const VoxelChange> changes) {
  Add(stamp, changes);
  scans_.push_back(ToIdl(stamp, scan));
}

void MapLog::Add(Time stamp, std::span<const VoxelChange> changes) {
  stamp_ = stamp;
  changes_.insert(changes_.end(), changes.begin(), changes.end());
}

thalweg_msgs::msg::MapUpdate MapLog::TakeUpdate() {
  ++number_;
  thalweg_msgs::msg::MapUpdate update = MakeUpdate(false);
  update.scans(std::exchange(scans_, {}));
  update.blocks(BlocksOf(changes_));
  changes_.clear();
  return update;
}

thalweg_msgs::msg::MapUpdate MapLog::FullCopy(const OccupancyGrid& grid) const {
  thalweg_msgs::msg::MapUpdate update = MakeUpdate(true);
  update.blocks(BlocksOf(grid));
  return update;
}

thalweg_msgs::msg::MapUpdate MapLog::MakeUpdate(bool full) const {
  thalweg_msgs::msg::MapUpdate update;
  update.header(MakeHeader(stamp_, kMapFrame));
  update.session(session_);
  update.number(number_);
  update.full(full);
  update.voxel_size_m(voxel_size_);
  return update;
}

}  // namespace thalweg::dds
