#include "services/explorer/core/remembered_asides.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/services/explorer/support/knowing.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

using test::kNow;
using testing::UnorderedElementsAreArray;

const FrontierOptions kFrontier{.min_area = 0.0, .extent = 100.0};

/// A room of 6 x 1.2 x 1.2 m with an opening of one voxel on the left and one of two on the right.
std::vector<VoxelChange> RoomWithTwoOpenings() {
  std::vector<VoxelChange> changes = test::ClosedRoom(test::kLongRoom);
  std::erase_if(changes, [](const VoxelChange& change) {
    return change.voxel == VoxelIndex{-1, 6, 6} || change.voxel == VoxelIndex{60, 6, 6} ||
           change.voxel == VoxelIndex{60, 6, 7};
  });
  return changes;
}
const std::vector<VoxelIndex> kLeft = {{-1, 6, 6}};
const std::vector<VoxelIndex> kRight = {{60, 6, 6}, {60, 6, 7}};

class RememberedAsidesTest : public testing::Test {
 protected:
  Result<Cluster> Ignore(const Eigen::Vector3d& p_W) {
    return asides_.Ignore(p_W, kFrontier, knowledge_, kNow);
  }
  std::vector<VoxelIndex> Aside(AsideReason reason) const {
    const auto voxels = knowledge_.memory().SetAsideVoxels();
    const auto found = voxels.find(reason);
    return found == voxels.end() ? std::vector<VoxelIndex>{} : found->second;
  }
  /// As if the mapper had sent a whole new map.
  void ReplaceMap(const std::vector<VoxelChange>& changes = RoomWithTwoOpenings()) {
    knowledge_.Reset();
    knowledge_.Update(changes, {}, kNow);
  }

  Knowledge knowledge_ = test::Knowing(RoomWithTwoOpenings());
  RememberedAsides asides_;
};

TEST_F(RememberedAsidesTest, TheFrontierNearestToThePointIsIgnored) {
  Knowledge left = test::Knowing(RoomWithTwoOpenings());
  EXPECT_THAT(RememberedAsides().Ignore({0.4, 0.65, 0.65}, kFrontier, left, kNow)->unknowns,
              UnorderedElementsAreArray(kLeft));
  const auto ignored = Ignore({5.6, 0.65, 0.65});
  ASSERT_TRUE(ignored) << ignored.error();
  EXPECT_THAT(ignored->unknowns, UnorderedElementsAreArray(kRight));
  EXPECT_THAT(Aside(AsideReason::kIgnored), UnorderedElementsAreArray(kRight));
  EXPECT_EQ(asides_.ignored(), 2U);
  for (const VoxelIndex& i : kRight) EXPECT_TRUE(IsIgnored(knowledge_.memory(), i));
  EXPECT_FALSE(IsIgnored(knowledge_.memory(), kLeft.front()));
}

TEST_F(RememberedAsidesTest, OneThatIsSetAsideForAnotherReasonIsIgnoredToo) {
  for (const VoxelIndex& i : kRight) knowledge_.memory().SetAside(i, AsideReason::kVisited, kNow);
  ASSERT_TRUE(Ignore({5.6, 0.65, 0.65}));
  EXPECT_THAT(Aside(AsideReason::kIgnored), UnorderedElementsAreArray(kRight));
  EXPECT_TRUE(Aside(AsideReason::kVisited).empty());
}

TEST_F(RememberedAsidesTest, WhereNoneIsNearItSaysWhereTheNearestIs) {
  const auto far = Ignore({2.0, 0.65, 0.65});
  ASSERT_FALSE(far);
  EXPECT_EQ(far.error(), "the frontier nearest to (2.00, 0.65, 0.65) is at (-0.05, 0.65, 0.65)");
  EXPECT_EQ(asides_.ignored(), 0U);
  ASSERT_TRUE(Ignore({0.0, 0.65, 0.65}));
  ASSERT_TRUE(Ignore({6.0, 0.65, 0.65}));
  const auto none = Ignore({6.0, 0.65, 0.65});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error(), "there is no frontier that is not ignored already");
}

TEST_F(RememberedAsidesTest, InANewMapTheyAreSetAsideAgainUnlessTheyBecameKnown) {
  ASSERT_TRUE(Ignore({0.0, 0.65, 0.65}));
  ASSERT_TRUE(Ignore({6.0, 0.65, 0.65}));
  std::vector<VoxelChange> changes = RoomWithTwoOpenings();
  changes.push_back({kRight.front(), test::kOccupiedLogOdds});
  ReplaceMap(changes);
  EXPECT_TRUE(Aside(AsideReason::kIgnored).empty());
  asides_.SetAsideAgain(knowledge_, kNow);
  EXPECT_THAT(Aside(AsideReason::kIgnored), testing::UnorderedElementsAre(kLeft.front(), kRight.back()));
  ReplaceMap();
  asides_.SetAsideAgain(knowledge_, kNow);
  EXPECT_EQ(Aside(AsideReason::kIgnored).size(), 3U) << "for good";
}

TEST_F(RememberedAsidesTest, AnotherProcessSetsAsideWhatThisOneSaved) {
  ASSERT_TRUE(Ignore({0.0, 0.65, 0.65}));
  for (const VoxelIndex& i : kRight) knowledge_.memory().SetAside(i, AsideReason::kVisited, kNow);
  std::vector<SavedExploration::Aside> saved;
  asides_.SaveTo(saved, knowledge_);
  EXPECT_EQ(saved.size(), 3U) << "each once, also the ignored one";

  RememberedAsides other;
  other.Restore(saved);
  EXPECT_EQ(other.ignored(), 1U);
  std::vector<SavedExploration::Aside> saved_before_the_map;
  ReplaceMap({});
  other.SaveTo(saved_before_the_map, knowledge_);
  EXPECT_THAT(saved_before_the_map, UnorderedElementsAreArray(saved)) << "nothing is lost without a map";

  ReplaceMap();
  other.SetAsideAgain(knowledge_, kNow);
  EXPECT_THAT(Aside(AsideReason::kIgnored), UnorderedElementsAreArray(kLeft));
  EXPECT_THAT(Aside(AsideReason::kVisited), UnorderedElementsAreArray(kRight));
  ReplaceMap();
  other.SetAsideAgain(knowledge_, kNow);
  EXPECT_THAT(Aside(AsideReason::kIgnored), UnorderedElementsAreArray(kLeft)) << "for good";
  EXPECT_TRUE(Aside(AsideReason::kVisited).empty()) << "once";
}

}  // namespace
}  // namespace thalweg::explorer
