#include "services/gateway/core/block_feed.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "services/gateway/core/cdr_writer.h"

namespace thalweg::gateway {
namespace {

std::int64_t KnownIn(const std::array<std::uint8_t, BlockStates::kBytes>& octets) {
  std::int64_t known = 0;
  for (const unsigned octet : octets) known += std::popcount((octet | octet >> 1) & 0x55U);
  return known;
}

}  // namespace

BlockStates StatesOf(const VoxelIndex& index, const OccupancyGrid::Block& block) {
  BlockStates states{index, {}};
  for (std::size_t k = 0; k < block.size(); ++k) {
    const auto state = static_cast<unsigned>(OccupancyGrid::StateOf(block[k]));
    states.octets[k / 4] = static_cast<std::uint8_t>(states.octets[k / 4] | state << (2 * (k % 4)));
  }
  return states;
}

void BlockFeed::Update(Time stamp, double voxel_size, bool replaced, const std::vector<BlockStates>& blocks) {
  stamp_ = stamp;
  voxel_size_ = voxel_size;
  if (replaced || start_ == 0) {
    blocks_.clear();
    by_change_.clear();
    known_ = 0;
    start_ = ++changes_;
  }
  for (const BlockStates& block : blocks) {
    Entry& entry = blocks_[block.block];
    if (entry.changed != 0) {
      if (entry.octets == block.octets) continue;  // log-odds changed, but no state
      by_change_.erase(entry.changed);
      known_ -= KnownIn(entry.octets);
    }
    known_ += KnownIn(block.octets);
    entry = {++changes_, block.octets};
    by_change_[entry.changed] = block.block;
  }
}

double BlockFeed::known_volume() const {
  return static_cast<double>(known_) * voxel_size_ * voxel_size_ * voxel_size_;
}

std::optional<Feed::Message> BlockFeed::Next(std::uint64_t& cursor) const {
  if (start_ == 0) return std::nullopt;
  const bool reset = cursor < start_;
  auto change = by_change_.upper_bound(cursor);
  if (!reset && change == by_change_.end()) return std::nullopt;
  std::vector<std::int16_t> position;
  std::vector<std::uint8_t> octets;
  cursor = std::max(cursor, start_);
  for (std::size_t n = 0; n < kMaxBlocks && change != by_change_.end(); ++n, ++change) {
    cursor = change->first;
    const VoxelIndex& block = change->second;
    for (const std::int32_t c : {block.x, block.y, block.z}) position.push_back(static_cast<std::int16_t>(c));
    const auto& states = blocks_.at(block).octets;
    octets.insert(octets.end(), states.begin(), states.end());
  }
  CdrWriter cdr;
  cdr.Put(voxel_size_);
  cdr.Put(static_cast<std::uint8_t>(reset));
  cdr.PutSequence(position);
  cdr.PutSequence(octets);
  return Message{stamp_, std::make_shared<const std::vector<std::uint8_t>>(cdr.Take())};
}

}  // namespace thalweg::gateway
