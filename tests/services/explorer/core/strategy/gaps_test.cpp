#include "services/explorer/core/strategy/gaps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/services/explorer/support/rooms.h"
#include "tests/services/explorer/support/situations.h"

namespace thalweg::explorer {
namespace {

constexpr int kFloor = 1;  ///< The lowest voxel of the band that the robot sweeps, to 5.

/// A corridor of 8 x 1 m along x with three rooms of 1 x 2 m above it, at x = 1, 4 and 7 m, each behind a
/// doorway as wide as the room's left half. What is unknown is on the right, out of sight from the corridor's
/// middle line; a robot in front of a doorway sees half of a room.
///
///     .--. .--. .--.
///     |  | |  | |  |
///     | -' | -' | -'
///     '            '-
///      -------------
class ThreeRooms : public testing::Test {
 protected:
  struct Unknown {
    VoxelBox box;
    VoxelIndex goal;  ///< From where it is in sight.
  };
  ThreeRooms() {
    map_.SetPlane(0.35);
    Put({{-1, -1, 0}, {81, 35, 7}}, VoxelState::kOccupied);
    Put({{0, 0, 0}, {80, 10, 7}}, VoxelState::kFree);
    for (const int x : {10, 40, 70}) {
      Put({{x, 12, 0}, {x + 10, 32, 7}}, VoxelState::kFree);
      Put({{x, 10, 0}, {x + 5, 12, 7}}, VoxelState::kFree);
    }
  }
  void Put(const VoxelBox& box, VoxelState state) { map_.Apply(test::BoxOf(box, state)); }
  /// Something to see in the corner of a room; `x` is that of the room.
  void PutUnknownIn(int x) {
    unknown_.push_back({{{x + 8, 12, kFloor}, {x + 10, 16, kFloor + 5}}, {x + 4, 16, 3}});
  }

  /// Where the strategy goes from there: the x of the candidate's room, or of the place [voxels].
  int GoesTo(const VoxelIndex& robot) {
    for (const Unknown& unknown : unknown_) Put(unknown.box, VoxelState::kUnknown);
    search_.Flood(map_, {{robot, 0}});
    candidates_.clear();
    for (const Unknown& unknown : unknown_) {
      Candidate candidate;
      ForEachVoxel(unknown.box, [&](const VoxelIndex& i) { candidate.cluster.unknowns.push_back(i); });
      candidate.goals = {unknown.goal};
      candidate.length = search_.Length(unknown.goal);
      candidates_.push_back(std::move(candidate));
    }
    const Choice choice = gaps_.Choose({map_, search_, map_.CenterOf(robot), 0.2, candidates_, test::kViews,
                                        test::kSensorRange, test::kLookRange});
    EXPECT_EQ(choice.path_W.front(), map_.CenterOf(robot));
    return unknown_.at(choice.candidate).box.min.x - 8;
  }
  /// What was to be seen in a room is known now.
  void See(std::size_t which) {
    Put(unknown_.at(which).box, VoxelState::kFree);
    unknown_.erase(unknown_.begin() + static_cast<std::ptrdiff_t>(which));
  }

  PlanningMap map_{{.voxel_size = 0.1, .clearance = 0.2, .half_height = 0.2, .bounds = {}}};
  PathSearch search_;
  std::vector<Unknown> unknown_;
  std::vector<Candidate> candidates_;
  Gaps gaps_;
};

TEST_F(ThreeRooms, EachIsAGapAndWhatIsInPlainSightComesFirst) {
  PutUnknownIn(10);
  PutUnknownIn(70);
  EXPECT_EQ(GoesTo({20, 5, 3}), 70) << "the one that was seen first last, in the map's order";
  EXPECT_EQ(gaps_.tree().Leaves().size(), 3U);
  unknown_.push_back({{{0, 0, kFloor}, {2, 10, kFloor + 5}}, {5, 5, 3}});
  EXPECT_EQ(GoesTo({20, 5, 3}), -8) << "in plain sight";
}

TEST_F(ThreeRooms, TheOneChosenIsKeptUntilItIsSeen) {
  for (const int x : {10, 40, 70}) PutUnknownIn(x);
  EXPECT_EQ(GoesTo({20, 5, 3}), 70);
  EXPECT_EQ(GoesTo({35, 5, 3}), 70) << "although the middle one is nearer";
  See(2);
  EXPECT_EQ(GoesTo({35, 5, 3}), 40);
  See(1);
  EXPECT_EQ(GoesTo({35, 5, 3}), 10);
}

TEST_F(ThreeRooms, OneWithinAnotherComesAfterOneInSight) {
  PutUnknownIn(40);
  PutUnknownIn(70);
  EXPECT_EQ(GoesTo({20, 5, 3}), 70);
  // From inside the first room the corridor and the other rooms are one gap.
  PutUnknownIn(10);
  const int next = GoesTo({12, 25, 3});
  EXPECT_EQ(next, 70) << "the one chosen before, although it lies within now";
  const auto leaf = gaps_.tree().LeafAt({79, 13, 0});
  ASSERT_TRUE(leaf);
  EXPECT_GT(gaps_.tree().Level(*leaf), 0U);
  See(1);
  EXPECT_EQ(GoesTo({12, 25, 3}), 10) << "in plain sight now";
}

TEST_F(ThreeRooms, UnknownVoxelsAboveAndBelowAWallBelongToWhatIsBesideIt) {
  PutUnknownIn(70);
  // The upper half of the wall's end was not seen.
  unknown_.push_back({{{80, 2, kFloor + 2}, {81, 8, kFloor + 5}}, {76, 5, 3}});
  EXPECT_EQ(GoesTo({20, 5, 3}), 72) << "in plain sight beside the wall";
}

TEST_F(ThreeRooms, AreSimplyConnectedUntilAPillarStandsInOne) {
  search_.Flood(map_, {{{20, 5, 3}, 0}});
  EXPECT_FALSE(gaps_.FindMisfit(map_, search_));
  Put({{40, 12, 0}, {55, 32, 7}}, VoxelState::kFree);
  Put({{46, 20, 0}, {48, 22, 7}}, VoxelState::kOccupied);
  search_.Flood(map_, {{{20, 5, 3}, 0}});
  const auto place = gaps_.FindMisfit(map_, search_);
  ASSERT_TRUE(place);
  EXPECT_LT((*place - Eigen::Vector3d(4.7, 2.1, 0.35)).norm(), 1e-9);
}

}  // namespace
}  // namespace thalweg::explorer
