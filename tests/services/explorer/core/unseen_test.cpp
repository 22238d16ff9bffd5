#include "services/explorer/core/unseen.h"

#include <gtest/gtest.h>

#include "tests/services/explorer/support/knowing.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

using test::kNow;

constexpr std::size_t kFarEndVoxels = 12 * 12;  // [voxels]

/// The long room, with a wall across it from which the unknown space at the far end cannot be seen.
class UnseenTest : public testing::Test {
 protected:
  UnseenTest() {
    knowledge_.Update(test::BoxOf({{25, 0, 0}, {26, 12, 12}}, VoxelState::kOccupied), {}, kNow);
    search_.Flood(knowledge_.map(), {{knowledge_.map().IndexOf(test::kHere.translation()), 0}});
  }
  void SetAside(AsideReason reason) {
    test::ForEachVoxel({{60, 0, 0}, {61, 12, 12}},
                       [&](const VoxelIndex& i) { knowledge_.memory().SetAside(i, reason, kNow); });
  }
  std::vector<Unseen> Find(const PlanningMap& other) const {
    return FindUnseen(other, knowledge_, search_, GoalFinder(2.0, 0.1), 0.8);
  }
  /// The map with a hole in the wall.
  PlanningMap Opened() const {
    PlanningMap map = knowledge_.map();
    map.Apply(test::BoxOf({{25, 3, 3}, {26, 9, 9}}, VoxelState::kFree));
    return map;
  }

  Knowledge knowledge_ = test::Knowing(test::LongRoom());
  PathSearch search_;
};

TEST_F(UnseenTest, IsWhatWasOutOfSightAndTheOtherMapLetsTheRobotSee) {
  SetAside(AsideReason::kOutOfSight);
  EXPECT_TRUE(Find(knowledge_.map()).empty());
  const PlanningMap opened = Opened();
  std::size_t voxels = 0;
  std::size_t before = 0;
  for (const Unseen& unseen : Find(opened)) {
    voxels += unseen.cluster.unknowns.size();
    EXPECT_GE(unseen.path.size(), before) << "the shortest paths come first";
    before = unseen.path.size();
    EXPECT_TRUE(search_.Reached(unseen.path.front()));
    ASSERT_TRUE(unseen.Bar());
    EXPECT_FALSE(search_.Reached(*unseen.Bar()));
    EXPECT_NEAR(unseen.Bar()->x, 24, 1) << "before the wall";
    for (const VoxelIndex& i : unseen.path) EXPECT_TRUE(opened.Traversable(i));
  }
  EXPECT_EQ(voxels, kFarEndVoxels);
}

TEST_F(UnseenTest, IsNotWhatWasSetAsideForAnotherReason) {
  SetAside(AsideReason::kVisited);
  EXPECT_TRUE(Find(Opened()).empty());
}

TEST_F(UnseenTest, HasNoBarWhereTheRobotCanBeAlready) {
  SetAside(AsideReason::kOutOfSight);
  PathSearch everywhere;
  everywhere.Flood(Opened(), {{knowledge_.map().IndexOf(test::kHere.translation()), 0}});
  const std::vector<Unseen> found = FindUnseen(Opened(), knowledge_, everywhere, GoalFinder(2.0, 0.1), 0.8);
  ASSERT_FALSE(found.empty());
  for (const Unseen& unseen : found) {
    EXPECT_EQ(unseen.path.size(), 1U);
    EXPECT_FALSE(unseen.Bar());
  }
}

}  // namespace
}  // namespace thalweg::explorer
