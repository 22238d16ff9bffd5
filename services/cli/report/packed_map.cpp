#include "services/cli/report/packed_map.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <map>

#include "common/voxel/grid_order.h"

namespace thalweg::cli {
namespace {

struct Block {
  std::bitset<OccupancyGrid::kBlockVoxels> occupied;
  std::array<std::uint8_t, OccupancyGrid::kBlockVoxels> known_at{};
};

/// Ordered, so that the same map always gives the same bytes, and neighbors compress well.
using Blocks = std::map<VoxelIndex, Block, GridOrder>;

VoxelIndex Coarse(const VoxelIndex& i, int halvings) {
  return {i.x >> halvings, i.y >> halvings, i.z >> halvings};
}

bool IsNear(const VoxelIndex& block) {
  const auto near = [](std::int32_t c) { return c >= -kFarthestBlock && c < kFarthestBlock; };
  return near(block.x) && near(block.y) && near(block.z);
}

/// @return The number of occupied voxels that are too far away.
std::size_t AddOccupied(const OccupancyGrid& grid, int halvings, Blocks& blocks) {
  std::size_t left_out = 0;
  grid.ForEachKnown([&](const VoxelIndex& fine, float log_odds) {
    if (OccupancyGrid::StateOf(log_odds) != VoxelState::kOccupied) return;
    const VoxelIndex voxel = Coarse(fine, halvings);
    const VoxelIndex at = OccupancyGrid::BlockOf(voxel);
    if (!IsNear(at)) {
      ++left_out;
      return;
    }
    Block& block = blocks[at];
    const std::size_t offset = OccupancyGrid::OffsetInBlock(voxel);
    block.occupied[offset] = true;
    block.known_at[offset] = 255;  // unless the tally knows better
  });
  return left_out;
}

void AddTimes(const CoverageTally& tally, double duration, int halvings, Blocks& blocks) {
  tally.ForEachKnown([&](const VoxelIndex& fine, double time) {
    const VoxelIndex voxel = Coarse(fine, halvings);
    const auto block = blocks.find(OccupancyGrid::BlockOf(voxel));
    if (block == blocks.end()) return;
    const double share = duration > 0.0 ? std::clamp(time / duration, 0.0, 1.0) : 0.0;
    std::uint8_t& known_at = block->second.known_at[OccupancyGrid::OffsetInBlock(voxel)];
    known_at = std::min(known_at, static_cast<std::uint8_t>(std::lround(255.0 * share)));
  });
}

}  // namespace

PackedMap Pack(const OccupancyGrid& grid, const CoverageTally& tally, double duration, int halvings) {
  Blocks blocks;
  PackedMap packed;
  packed.voxel_size = std::ldexp(grid.voxel_size(), halvings);
  packed.left_out = AddOccupied(grid, halvings, blocks);
  AddTimes(tally, duration, halvings, blocks);
  packed.blocks = blocks.size();
  for (const auto& [at, block] : blocks) {
    for (const std::int32_t c : {at.x, at.y, at.z}) {
      const auto bits = static_cast<std::uint16_t>(c);
      packed.bytes.push_back(static_cast<std::uint8_t>(bits & 255U));
      packed.bytes.push_back(static_cast<std::uint8_t>(bits >> 8U));
    }
  }
  for (const auto& [at, block] : blocks) {
    for (std::size_t octet = 0; octet < OccupancyGrid::kBlockVoxels / 8; ++octet) {
      unsigned bits = 0;
      for (std::size_t k = 0; k < 8; ++k) bits |= block.occupied[8 * octet + k] ? 1U << k : 0U;
      packed.bytes.push_back(static_cast<std::uint8_t>(bits));
    }
  }
  for (const auto& [at, block] : blocks) {
    for (std::size_t k = 0; k < block.known_at.size(); ++k) {
      if (!block.occupied[k]) continue;
      packed.bytes.push_back(block.known_at[k]);
      ++packed.occupied;
    }
  }
  return packed;
}

}  // namespace thalweg::cli
