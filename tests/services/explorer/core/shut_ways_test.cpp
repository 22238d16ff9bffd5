#include "services/explorer/core/shut_ways.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

using std::chrono_literals::operator""s;
using testing::IsEmpty;
using testing::SizeIs;

constexpr VoxelBox kDoor{{30, 0, 0}, {31, 12, 12}};  // across the long room

/// A robot at the near end of the long room, whose far end it has not seen.
class ShutWaysTest : public testing::Test {
 protected:
  ShutWaysTest() { Learn(test::LongRoom()); }
  void Learn(const std::vector<VoxelChange>& changes) {
    knowledge_.Update(changes, {}, test::kStart);
    search_.Flood(knowledge_.map(),
                  PathSearch::StartAt(knowledge_.map(), test::kHere.translation(), 0.1, {0.3}));
  }
  void Shut() { Learn(test::BoxOf(kDoor, VoxelState::kOccupied)); }
  std::vector<ShutWays::Way> Find() const { return ways_.Find(knowledge_, search_); }

  ExplorerOptions options_ = test::GoingOptions();
  Knowledge knowledge_{KnowledgeOptions(options_)};
  PathSearch search_;
  ShutWays ways_{ShutWayOptions(options_)};
};

TEST_F(ShutWaysTest, ADoorThatIsShutBeforeWhatIsLeftToSeeIsOne) {
  ways_.Note(search_);
  EXPECT_THAT(Find(), IsEmpty()) << "it is open";
  Shut();
  const std::vector<ShutWays::Way> ways = Find();
  ASSERT_THAT(ways, SizeIs(1));
  EXPECT_EQ(ways[0].bar.x, 30);
  EXPECT_GT(ways[0].unknowns, 100U) << "of the far wall's 144";
  EXPECT_LE(ways[0].unknowns, 144U);
}

TEST_F(ShutWaysTest, OneToWhichTheRobotTwiceDidNotGetIsGivenUp) {
  ways_.Note(search_);
  Shut();
  const std::vector<ShutWays::Way> ways = Find();
  ASSERT_THAT(ways, SizeIs(1));
  ways_.DidNotGetTo(ways[0].bar);
  EXPECT_TRUE(ways_.MayWatch(ways[0]));
  ways_.DidNotGetTo(ways[0].bar);
  EXPECT_FALSE(ways_.MayWatch(ways[0]));
  ways_.Clear();
  EXPECT_TRUE(ways_.MayWatch(ways[0]));
}

TEST_F(ShutWaysTest, OneThatIsOpenAgainIsNone) {
  ways_.Note(search_);
  Shut();
  ASSERT_THAT(Find(), SizeIs(1));
  Learn(test::BoxOf(kDoor, VoxelState::kFree));
  EXPECT_THAT(Find(), IsEmpty());
}

TEST_F(ShutWaysTest, AWallThatWasNeverOpenIsNone) {
  Shut();
  ways_.Note(search_);
  EXPECT_THAT(Find(), IsEmpty());
}

TEST_F(ShutWaysTest, ADoorBehindWhichAllIsKnownIsNone) {
  Learn(test::FarWall());
  ways_.Note(search_);
  Shut();
  EXPECT_THAT(Find(), IsEmpty());
}

TEST_F(ShutWaysTest, TwoDoorsAreTwoWaysTheNearestFirst) {
  // Rooms on both sides of the robot's, each with a far wall that is not seen yet.
  for (const int side : {-1, 1}) {
    const int near = side < 0 ? -40 : 60;
    std::vector<VoxelChange> room = test::ClosedRoom({{near, 0, 0}, {near + 40, 12, 12}});
    std::erase_if(
        room, [&](const VoxelChange& change) { return change.voxel.x == (side < 0 ? near - 1 : near + 40); });
    Learn(room);
  }
  Learn(test::BoxOf({{-1, 0, 0}, {1, 12, 12}}, VoxelState::kFree));  // the walls between them
  Learn(test::BoxOf({{59, 0, 0}, {61, 12, 12}}, VoxelState::kFree));
  ways_.Note(search_);
  Learn(test::BoxOf({{-3, 0, 0}, {-2, 12, 12}}, VoxelState::kOccupied));
  Learn(test::BoxOf({{62, 0, 0}, {63, 12, 12}}, VoxelState::kOccupied));
  const std::vector<ShutWays::Way> ways = Find();
  ASSERT_THAT(ways, SizeIs(2));
  EXPECT_EQ(std::min(ways[0].bar.x, ways[1].bar.x), -3);
  EXPECT_EQ(std::max(ways[0].bar.x, ways[1].bar.x), 62);
}

TEST_F(ShutWaysTest, AWayIsGivenUpOnceItWasWatchedForSoLong) {
  ways_.Note(search_);
  Shut();
  const ShutWays::Way way = Find().at(0);
  ways_.Watch(way, test::kStart);
  ways_.Watch(way, test::kStart + 29s);
  EXPECT_TRUE(ways_.MayWatch(way));
  const ShutWays::Way beside{way.bar + VoxelIndex{0, 3, 0}, 1};
  ways_.Watch(beside, test::kStart + 31s);
  EXPECT_FALSE(ways_.MayWatch(way)) << "its bar may be another voxel of the same door";
  EXPECT_TRUE(ways_.MayWatch({way.bar + VoxelIndex{0, 20, 0}, 1})) << "that is another way";
}

TEST_F(ShutWaysTest, TimeThatPassesElsewhereDoesNotCount) {
  ways_.Note(search_);
  Shut();
  const ShutWays::Way way = Find().at(0);
  const ShutWays::Way other{way.bar + VoxelIndex{0, 30, 0}, 1};
  ways_.Watch(way, test::kStart);
  ways_.Watch(other, test::kStart + 40s);
  ways_.Watch(way, test::kStart + 60s);
  EXPECT_TRUE(ways_.MayWatch(way));
  ways_.ShiftTimes(40s);  // the clock went back
  ways_.Watch(way, test::kStart + 40s);
  EXPECT_TRUE(ways_.MayWatch(way));
  ways_.Watch(way, test::kStart + 51s);
  EXPECT_FALSE(ways_.MayWatch(way));
}

TEST_F(ShutWaysTest, WithoutPatienceThereIsNone) {
  options_.shut_way_patience = 0s;
  ways_ = ShutWays(ShutWayOptions(options_));
  ways_.Note(search_);
  Shut();
  EXPECT_THAT(Find(), IsEmpty());
}

}  // namespace
}  // namespace thalweg::explorer
