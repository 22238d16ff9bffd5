#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "common/voxel/occupancy_grid.h"
#include "services/gateway/core/blocks_by_change.h"
#include "services/gateway/core/session.h"

namespace thalweg::gateway {

/// What is known of a block of 8^3 voxels, 2 bits each: voxel k (x fastest, then y, then z) has the bits
/// 2 (k % 4) and above of octet k / 4. 0 unknown, 1 free, 2 occupied, as VoxelState.
struct BlockStates {
  static constexpr std::size_t kBytes = OccupancyGrid::kBlockVoxels / 4;
  VoxelIndex block;
  std::array<std::uint8_t, kBytes> octets;
};
BlockStates StatesOf(const VoxelIndex& index, const OccupancyGrid::Block& block);

/// The map for a viewer: the state of every block, then of those that changed.
class BlockFeed final : public Feed {
 public:
  static constexpr std::string_view kTopic = "thalweg/blocks";
  static constexpr std::string_view kSchemaName = "thalweg_msgs/msg/BlockStates";
  static constexpr std::string_view kSchema =
      "# The states of blocks of 8 x 8 x 8 voxels, 128 octets each.\n"
      "float64 voxel_size_m\n"
      "bool reset         # forget all earlier blocks\n"
      "int16[] position   # x, y, z of each block; it spans [8 x, 8 x + 8) in voxel indices\n"
      "uint8[] states     # voxel (z * 8 + y) * 8 + x: 2 bits, lowest first; 0 unknown, 1 free, 2 occupied\n";
  static constexpr std::size_t kMaxBlocks = 1024;  ///< In one message, so that others can pass between.

  /// @param replaced  The map is another one: blocks that are not in `blocks` are unknown.
  void Update(Time stamp, double voxel_size, bool replaced, const std::vector<BlockStates>& blocks);
  std::optional<Message> Next(std::uint64_t& cursor) const override;

  double known_volume() const;  ///< [m^3] Volume of the voxels that are free or occupied.

  using Octets = std::array<std::uint8_t, BlockStates::kBytes>;
  /// Calls use(index, octets) for every block.
  template <class Use>
  void ForEachBlock(Use&& use) const {
    blocks_.ForEach(std::forward<Use>(use));
  }
  double voxel_size() const { return voxel_size_; }
  Time stamp() const { return stamp_; }
  std::uint64_t version() const { return blocks_.changes(); }  ///< Grows with each change; 0 = no map yet.

 private:
  Time stamp_;
  double voxel_size_ = 0.0;
  BlocksByChange<Octets> blocks_;
  std::int64_t known_ = 0;  ///< Voxels.
};

}  // namespace thalweg::gateway
