#include "services/explorer/core/map/open_border.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

constexpr AsideReason kReasons[] = {AsideReason::kNone,       AsideReason::kLookedAt,  AsideReason::kVisited,
                                    AsideReason::kOutOfSight, AsideReason::kLostThere, AsideReason::kNoDepth};

TEST(OpenBorder, EqualsBruteForce) {
  std::mt19937 random(5);
  for (int scene = 0; scene < 10; ++scene) {
    const VoxelBox box{{0, 0, 0}, {20, 15, 10}};
    PlanningMap map(
        {.bounds = Eigen::AlignedBox3d(Eigen::Vector3d(0.2, 0, 0), Eigen::Vector3d(1.8, 1.5, 1.0))});
    map.Apply(test::RandomScene(random, box, 12, 6));
    DenseGrid<std::uint8_t> set_aside(map.box(), 0);
    for (std::size_t k = 0; k < set_aside.size(); ++k) {
      set_aside[k] = static_cast<std::uint8_t>(kReasons[test::RandomInt(random, 0, 5)]);
    }
    std::size_t surface = 0;
    std::map<AsideReason, std::size_t> unknown;
    test::ForEachVoxel(map.box(), [&](const VoxelIndex& i) {
      bool beside_free = false;
      for (int axis = 0; axis < 3; ++axis) {
        for (const int step : {-1, 1}) {
          const VoxelIndex j =
              i + VoxelIndex{axis == 0 ? step : 0, axis == 1 ? step : 0, axis == 2 ? step : 0};
          beside_free |= map.InBounds(j) && map.State(j) == VoxelState::kFree;
        }
      }
      if (!beside_free) return;
      if (map.State(i) == VoxelState::kOccupied) ++surface;
      if (map.State(i) == VoxelState::kUnknown && map.InBounds(i))
        ++unknown[static_cast<AsideReason>(set_aside[i])];
    });
    const OpenBorder border = FindOpenBorder(map, set_aside);
    EXPECT_EQ(border.surface, surface);
    EXPECT_EQ(border.unknown, unknown);
    EXPECT_EQ(unknown.size(), std::size(kReasons));
    std::size_t open = 0;
    for (const auto& [reason, voxels] : unknown) open += voxels;
    EXPECT_EQ(border.open(), open);
    EXPECT_DOUBLE_EQ(border.share(), static_cast<double>(open) / static_cast<double>(open + surface));
  }
}

TEST(OpenBorder, MissedIsWhatWasTriedInVainAndAllThatIsOpenWhereThatIsMoreThanSurface) {
  OpenBorder border{.surface = 700,
                    .unknown = {{AsideReason::kNone, 50},
                                {AsideReason::kLookedAt, 20},
                                {AsideReason::kVisited, 30},
                                {AsideReason::kOutOfSight, 90},
                                {AsideReason::kLostThere, 10},
                                {AsideReason::kNoDepth, 100}}};
  EXPECT_DOUBLE_EQ(border.share(), 0.3);
  EXPECT_DOUBLE_EQ(border.missed_share(), 0.16);
  border.hidden = 60;
  EXPECT_DOUBLE_EQ(border.missed_share(), 0.22);
  border.hidden = 0;
  border.surface = 300;
  EXPECT_DOUBLE_EQ(border.missed_share(), 160.0 / 600.0);
  border.surface = 200;
  EXPECT_DOUBLE_EQ(border.missed_share(), 0.6);
}

TEST(OpenBorder, OfAMapWithNothingInItIsNone) {
  const PlanningMap map({});
  const OpenBorder border = FindOpenBorder(map, DenseGrid<std::uint8_t>(map.box(), 0));
  EXPECT_EQ(border.open(), 0U);
  EXPECT_EQ(border.share(), 0.0);
  EXPECT_EQ(border.missed_share(), 0.0);
}

}  // namespace
}  // namespace thalweg::explorer
