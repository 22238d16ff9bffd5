#include "services/explorer/core/strategy/flow.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "tests/services/explorer/support/situations.h"

namespace thalweg::explorer {
namespace {

class FlowOnRandomMaps : public test::OnRandomMaps {};
INSTANTIATE_TEST_SUITE_P(Seeds, FlowOnRandomMaps, testing::Range(1U, 21U));

TEST_P(FlowOnRandomMaps, KeepsToFreeSpaceAndIsTheSameEachTime) {
  for (const double eagerness : {0.0, 1.0}) {
    Flow flow({.eagerness = eagerness});
    Flow again({.eagerness = eagerness});
    for (int n = 0; n < 3; ++n) {
      const Choice choice = flow.Choose(situation());
      ExpectGoodPath(choice);
      const Choice same = again.Choose(situation());
      EXPECT_EQ(same.candidate, choice.candidate);
      EXPECT_EQ(same.path_W, choice.path_W);
    }
  }
}

class FlowAmongSpecks : public test::RoomWithSpecks {
 protected:
  Choice ChooseAmong(const std::vector<VoxelIndex>& specks, double sight_worth = 0.0) {
    PutSpecks(specks);
    return Flow({.eagerness = 0.0, .sight_worth = sight_worth}).Choose(situation());
  }
};

TEST_F(FlowAmongSpecks, StopsWhereItSeesAll) {
  const std::vector<VoxelIndex> specks = {{60, 4, 6}, {62, 26, 6}};
  const Choice choice = ChooseAmong(specks);
  const VoxelIndex end = map_.IndexOf(choice.path_W.back());
  EXPECT_TRUE(Sees(end, specks[0]));
  EXPECT_TRUE(Sees(end, specks[1]));
  EXPECT_THAT(choice.target, testing::UnorderedElementsAreArray(specks));
  double shortest = std::numeric_limits<double>::infinity();
  for (const VoxelIndex& i : traversable_) {
    if (Sees(i, specks[0]) && Sees(i, specks[1])) shortest = std::min(shortest, search_.Length(i));
  }
  EXPECT_LE(search_.Length(end), shortest + 0.4);  // one voxel of each cell of three was tried
}

TEST_F(FlowAmongSpecks, SeesTheFirstOnItsWayToTheSecond) {
  // Both ends of the room's length: too far apart to be seen from one position.
  const std::vector<VoxelIndex> specks = {{20, 4, 6}, {66, 26, 6}};
  const Choice choice = ChooseAmong(specks);
  ASSERT_EQ(choice.candidate, 0U);
  const VoxelIndex end = map_.IndexOf(choice.path_W.back());
  EXPECT_TRUE(Sees(end, specks[0]));
  PathSearch onward;
  onward.Flood(map_, {{candidates_[1].goals.front(), 0}});
  // Rays leave gaps between the positions that were tried.
  EXPECT_LE(search_.Length(end) + onward.Length(end), onward.Length(kStart) + 0.2);
}

TEST_F(FlowAmongSpecks, GoesOnWhereItSeesPartOfALaterStop) {
  // The second and the third voxel form one stop, because they are near each other.
  const std::vector<VoxelIndex> specks = {{10, 4, 6}, {58, 26, 6}, {67, 26, 6}};
  const Choice thrifty = ChooseAmong(specks);
  EXPECT_EQ(thrifty.candidate, 0U);
  EXPECT_THAT(thrifty.target, testing::ElementsAre(specks[0]));
  candidates_.clear();
  const Choice far_sighted = ChooseAmong(specks, 100.0);
  EXPECT_EQ(far_sighted.candidate, 0U);
  EXPECT_THAT(far_sighted.target, testing::ElementsAre(specks[0], specks[1]));
  EXPECT_TRUE(Sees(map_.IndexOf(far_sighted.path_W.back()), specks[1]));
}

class FlowInACorridor : public test::Corridor {};

TEST_F(FlowInACorridor, GoesToADoubtfulClusterAfterAnUnknownOne) {
  for (const bool doubtful : {false, true}) {
    PutCandidates({{{-40, 0, 0}}, {{42, 0, 0}}});  // the unknown spaces beyond both ends have the same size
    test::ForEachVoxel({{-61, -2, -2}, {-60, 3, 3}}, [&](const VoxelIndex& i) {
      candidates_[0].cluster.unknowns.push_back(i);
      candidates_[1].cluster.unknowns.push_back({-1 - i.x, i.y, i.z});
    });
    candidates_[0].cluster.doubtful = doubtful;
    candidates_[0].cluster.weight = doubtful ? 0.5 : 1.0;
    EXPECT_EQ(Decide("flow").candidate, doubtful ? 1U : 0U);
  }
}

}  // namespace
}  // namespace thalweg::explorer
