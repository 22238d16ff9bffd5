#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "common/geometry/point_cloud.h"
#include "common/voxel/occupancy_grid.h"

namespace thalweg::mapper {

/// The mean color of each voxel, kept beside an OccupancyGrid. A value type: copies are independent.
/// After kMaxCount samples, each new color has weight 1 / kMaxCount, so that the mean follows a change.
class VoxelColors {
 public:
  static constexpr std::uint16_t kMaxCount = 100;

  /// Fixed point: 256 times the mean.
  struct Mean {
    std::uint16_t r = 0;
    std::uint16_t g = 0;
    std::uint16_t b = 0;
    std::uint16_t count = 0;  ///< 0 = no color.

    bool operator==(const Mean&) const = default;
  };
  using Block = std::array<Mean, OccupancyGrid::kBlockVoxels>;

  struct Added {
    Mean mean;             ///< The voxel's new one.
    bool changed = false;  ///< Whether At now returns another color than before.
  };
  Added Add(const VoxelIndex& voxel, const Rgb& color) {
    Mean& mean = blocks_[OccupancyGrid::BlockOf(voxel)][OccupancyGrid::OffsetInBlock(voxel)];
    const std::optional<Rgb> before = Rounded(mean);
    mean.count = std::min<std::uint16_t>(static_cast<std::uint16_t>(mean.count + 1), kMaxCount);
    const auto moved = [&mean](std::uint16_t old, std::uint8_t value) {
      return static_cast<std::uint16_t>(old + (value * 256 - old) / mean.count);
    };
    mean.r = moved(mean.r, color.r);
    mean.g = moved(mean.g, color.g);
    mean.b = moved(mean.b, color.b);
    return {mean, Rounded(mean) != before};
  }

  std::optional<Rgb> At(const VoxelIndex& voxel) const {
    const auto block = blocks_.find(OccupancyGrid::BlockOf(voxel));
    if (block == blocks_.end()) return std::nullopt;
    return Rounded(block->second[OccupancyGrid::OffsetInBlock(voxel)]);
  }

  const std::unordered_map<VoxelIndex, Block, VoxelIndexHash>& blocks() const { return blocks_; }
  Block& BlockAt(const VoxelIndex& block) { return blocks_[block]; }

 private:
  static std::optional<Rgb> Rounded(const Mean& mean) {
    if (mean.count == 0) return std::nullopt;
    const auto rounded = [](std::uint16_t v) {
      return static_cast<std::uint8_t>(std::min((v + 128) / 256, 255));
    };
    return Rgb{rounded(mean.r), rounded(mean.g), rounded(mean.b)};
  }

  std::unordered_map<VoxelIndex, Block, VoxelIndexHash> blocks_;
};

}  // namespace thalweg::mapper
