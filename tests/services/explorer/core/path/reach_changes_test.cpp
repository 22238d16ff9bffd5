#include "services/explorer/core/path/reach_changes.h"

#include <gtest/gtest.h>

#include "common/voxel/for_each_voxel.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

class ReachChangesTest : public testing::Test {
 protected:
  ReachChangesTest() {
    Set({{-5, -5, -5}, {45, 25, 15}}, VoxelState::kFree);
    Update();
  }
  void Set(const VoxelBox& box, VoxelState state) { map_.Apply(test::BoxOf(box, state)); }
  void Update() {
    search_.Flood(map_, {{{0, 0, 0}, 0}});
    changes_.Update(map_, search_);
  }
  std::uint32_t LastAt(const VoxelIndex& i) const { return changes_.LastIn(CubeAround(i, 0)); }

  PlanningMap map_{{.voxel_size = 0.1, .clearance = 0.15, .bounds = {}}};
  PathSearch search_;
  ReachChanges changes_;
};

TEST_F(ReachChangesTest, FindsWhatIsKnownAtFirst) {
  EXPECT_EQ(LastAt({0, 0, 0}), 1U);
  EXPECT_EQ(LastAt({-30, 0, 0}), 0U) << "in the map's box, where nothing is known";
  EXPECT_EQ(LastAt({-3000, 0, 0}), 0U) << "beyond the map's box";
}

TEST_F(ReachChangesTest, FindsAVoxelThatHasChangedAndNothingFartherThanABlock) {
  Update();
  Set(CubeAround({20, 3, 3}, 0), VoxelState::kOccupied);
  Update();
  EXPECT_EQ(LastAt({20, 3, 3}), 3U);
  EXPECT_EQ(LastAt({4, 3, 3}), 1U);
  EXPECT_EQ(LastAt({36, 3, 3}), 1U);
  EXPECT_EQ(changes_.LastIn({{0, 0, 0}, {20, 9, 9}}), 3U);
  Update();
  EXPECT_EQ(LastAt({20, 3, 3}), 3U);
}

TEST_F(ReachChangesTest, FindsWhatIsNoLongerReachedThoughItsStateIsTheSame) {
  Set({{20, -5, -5}, {21, 25, 15}}, VoxelState::kOccupied);
  Update();
  EXPECT_EQ(LastAt({40, 10, 10}), 2U) << "behind the wall";
  EXPECT_EQ(LastAt({0, 10, 10}), 1U) << "before it";
}

TEST_F(ReachChangesTest, EverythingHasChangedInAMapThatBeginsAgain) {
  map_.Reset();
  Set({{-5, -5, -5}, {15, 15, 15}}, VoxelState::kFree);
  Update();
  EXPECT_EQ(LastAt({0, 0, 0}), 2U);
  EXPECT_EQ(LastAt({20, 0, 0}), 2U) << "unknown again";
}

TEST_F(ReachChangesTest, RemembersWhenTheMapGrows) {
  const VoxelBox before = map_.box();
  Set({{45, -5, -5}, {130, 25, 15}}, VoxelState::kFree);
  Update();
  ASSERT_FALSE(map_.box() == before);
  EXPECT_EQ(LastAt({0, 0, 0}), 1U);
  EXPECT_EQ(LastAt({100, 0, 0}), 2U);
}

}  // namespace
}  // namespace thalweg::explorer
