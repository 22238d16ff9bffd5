#include "services/gateway/core/block_feed.h"

#include <bit>

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
  if (replaced || !blocks_.has_begun()) {
    blocks_.Restart();
    known_ = 0;
  }
  for (const BlockStates& block : blocks) {
    if (const Octets* const before = blocks_.Find(block.block)) {
      if (*before == block.octets) continue;  // log-odds changed, but no state
      known_ -= KnownIn(*before);
    }
    known_ += KnownIn(block.octets);
    blocks_.Set(block.block, block.octets);
  }
}

double BlockFeed::known_volume() const {
  return static_cast<double>(known_) * voxel_size_ * voxel_size_ * voxel_size_;
}

std::optional<Feed::Message> BlockFeed::Next(std::uint64_t& cursor) const {
  std::vector<std::int16_t> position;
  std::vector<std::uint8_t> octets;
  const auto reset = blocks_.TakeSince(cursor, [&](const VoxelIndex& block, const Octets& states) {
    if (octets.size() == kMaxBlocks * BlockStates::kBytes) return false;
    for (const std::int32_t c : {block.x, block.y, block.z}) position.push_back(static_cast<std::int16_t>(c));
    octets.insert(octets.end(), states.begin(), states.end());
    return true;
  });
  if (!reset) return std::nullopt;
  CdrWriter cdr;
  cdr.Put(voxel_size_);
  cdr.Put(static_cast<std::uint8_t>(*reset));
  cdr.PutSequence(position);
  cdr.PutSequence(octets);
  return Message{stamp_, std::make_shared<const std::vector<std::uint8_t>>(cdr.Take())};
}

}  // namespace thalweg::gateway
