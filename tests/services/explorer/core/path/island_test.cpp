#include "services/explorer/core/path/island.h"

#include <gtest/gtest.h>

#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

constexpr VoxelIndex kRobotCell{5, 5, 3};

/// A room of 4 x 3 m and 0.8 m height for a robot that drives in the band of voxels 1 to 5.
class DrivenRoom : public testing::Test {
 protected:
  DrivenRoom() {
    map_.SetPlane(0.35);
    map_.Apply(test::ClosedRoom({{0, 0, 0}, {40, 30, 8}}));
  }
  void Put(const VoxelBox& box, VoxelState state) { map_.Apply(test::BoxOf(box, state)); }
  std::optional<Eigen::Vector3d> Find() {
    search_.Flood(map_, {{kRobotCell, 0}});
    return FindIsland(map_, search_);
  }

  PlanningMap map_{{.voxel_size = 0.1, .clearance = 0.2, .half_height = 0.2, .bounds = {}}};
  PathSearch search_;
};

TEST_F(DrivenRoom, WithNothingInItHasNoIsland) {
  EXPECT_FALSE(Find());
}

TEST_F(DrivenRoom, WithAPillarHasOneInItsMiddle) {
  Put({{20, 14, 0}, {22, 18, 8}}, VoxelState::kOccupied);
  const auto island = Find();
  ASSERT_TRUE(island);
  EXPECT_LT((*island - Eigen::Vector3d(2.1, 1.6, 0.35)).norm(), 1e-9);
}

TEST_F(DrivenRoom, APillarWhoseInsideWasNeverSeenIsOne) {
  Put({{20, 14, 0}, {24, 18, 8}}, VoxelState::kOccupied);
  Put({{21, 15, 0}, {23, 17, 8}}, VoxelState::kUnknown);
  EXPECT_TRUE(Find());
}

TEST_F(DrivenRoom, WhatStandsAtTheWallIsNone) {
  Put({{20, 22, 0}, {22, 30, 8}}, VoxelState::kOccupied);
  EXPECT_FALSE(Find());
}

TEST_F(DrivenRoom, WhatStandsTooNearToTheWallForTheBodyIsNone) {
  Put({{20, 14, 0}, {22, 26, 8}}, VoxelState::kOccupied);  // a gap of 0.4 m
  EXPECT_FALSE(Find()) << "a body of 0.4 m fits nowhere but in its very middle, which is an edge of voxels";
  Put({{20, 25, 0}, {22, 26, 8}}, VoxelState::kFree);
  EXPECT_TRUE(Find());
}

TEST_F(DrivenRoom, WhatHangsAboveTheBandOrLiesBelowItIsNone) {
  Put({{20, 14, 6}, {22, 18, 8}}, VoxelState::kOccupied);
  Put({{20, 14, 0}, {22, 18, 1}}, VoxelState::kOccupied);
  EXPECT_FALSE(Find());
  Put({{20, 14, 5}, {22, 18, 6}}, VoxelState::kOccupied);
  EXPECT_TRUE(Find());
}

TEST_F(DrivenRoom, WhatWasSeenOfAPillarFromOneSideIsNone) {
  Put({{20, 14, 0}, {21, 18, 8}}, VoxelState::kOccupied);
  Put({{21, 10, 0}, {40, 22, 8}}, VoxelState::kUnknown);
  EXPECT_FALSE(Find()) << "it may reach to the wall behind it";
}

TEST_F(DrivenRoom, UnknownSpaceIsNone) {
  Put({{20, 14, 0}, {22, 18, 8}}, VoxelState::kUnknown);
  EXPECT_FALSE(Find());
}

TEST_F(DrivenRoom, ANoGoBoxIsNone) {
  map_.SetNoGo({{Eigen::Vector3d(2.0, 1.4, 0.0), Eigen::Vector3d(2.2, 1.8, 0.8)}});
  EXPECT_FALSE(Find());
}

TEST(FindIsland, ARobotThatFliesHasNone) {
  PlanningMap map({.voxel_size = 0.1, .clearance = 0.2, .bounds = {}});
  map.Apply(test::ClosedRoom({{0, 0, 0}, {40, 30, 8}}));
  map.Apply(test::BoxOf({{20, 14, 0}, {22, 18, 8}}, VoxelState::kOccupied));
  PathSearch search;
  search.Flood(map, {{kRobotCell, 0}});
  EXPECT_FALSE(FindIsland(map, search));
}

}  // namespace
}  // namespace thalweg::explorer
