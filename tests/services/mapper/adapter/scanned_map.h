#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "services/mapper/adapter/checkpoint.h"
#include "services/mapper/core/map_patch.h"
#include "services/mapper/core/occupancy_map.h"
#include "services/mapper/core/voxel_colors.h"
#include "tests/support/analytic_room.h"

namespace thalweg::test {

/// A map of the furnished room that grows scan by scan, and all its states so far.
class ScannedMap {
 public:
  explicit ScannedMap(unsigned seed = 7, int width_px = 24) : random_(seed), width_px_(width_px) {
    states_.push_back(Copy());
  }

  /// Fuses one more scan. @return What it changed.
  mapper::MapPatch Scan() {
    const RigidTransform T_WC = room_.RandomPose(random_);
    PointCloud cloud = room_.Render(PinholeCamera::FromFieldOfView(width_px_, width_px_ * 3 / 4, 1.3), T_WC);
    std::uniform_int_distribution<int> value(0, 255);
    const auto byte = [&] { return static_cast<std::uint8_t>(value(random_)); };
    for (std::size_t k = 0; k < cloud.points_C.size(); ++k) cloud.colors.push_back({byte(), byte(), byte()});
    mapper::MapPatch patch;
    const auto changes = map_.Integrate(cloud, T_WC);
    patch.voxels.assign(changes.begin(), changes.end());
    for (const auto& hit : map_.hits()) {
      patch.colors.push_back({hit.voxel, colors_.Add(hit.voxel, cloud.colors[hit.pixel]).mean});
    }
    states_.push_back(Copy());
    return patch;
  }

  std::size_t scans() const { return states_.size() - 1; }
  /// After so many scans. Its position has that number only.
  const mapper::Checkpoint& StateAfter(std::size_t scans) const { return states_.at(scans); }
  double voxel_size() const { return map_.grid().voxel_size(); }

 private:
  mapper::Checkpoint Copy() const {
    return {mapper::CopyOf(map_.grid()), colors_, {.map = 0, .writer = 0, .number = states_.size()}};
  }

  AnalyticRoom room_ = AnalyticRoom::Furnished();
  std::mt19937 random_;
  int width_px_;
  mapper::OccupancyMap map_{mapper::OccupancyMap::Options{.voxel_size = 0.2}};
  mapper::VoxelColors colors_;
  std::vector<mapper::Checkpoint> states_;
};

/// Expects the same log-odds and colors, bit by bit.
inline void ExpectSameMap(const mapper::Checkpoint& a, const mapper::Checkpoint& b) {
  EXPECT_TRUE(a.grid.SameAs(b.grid));
  EXPECT_EQ(a.colors.blocks(), b.colors.blocks());
}

}  // namespace thalweg::test
