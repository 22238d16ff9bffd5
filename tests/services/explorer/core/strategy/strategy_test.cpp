#include "services/explorer/core/strategy/strategy.h"

#include <gtest/gtest.h>

#include "tests/services/explorer/support/situations.h"

namespace thalweg::explorer {
namespace {

class StrategyOnRandomMaps : public test::OnRandomMaps {};
INSTANTIATE_TEST_SUITE_P(Seeds, StrategyOnRandomMaps, testing::Range(1U, 21U));

TEST_P(StrategyOnRandomMaps, ATurnCountsAsThePathThatItCosts) {
  const std::size_t nearest = Nearest();
  candidates_[nearest].turn = 1000.0;
  EXPECT_NE(NearestCandidate(situation()), nearest);
  for (Candidate& candidate : candidates_) candidate.turn = 1000.0;
  EXPECT_EQ(NearestCandidate(situation()), nearest);
}

TEST_P(StrategyOnRandomMaps, StraightenedOrNotAPathLeadsToTheFirstGoal) {
  for (std::size_t n = 0; n < candidates_.size(); ++n) {
    Situation situation = this->situation();
    const Choice pulled = StraightTo(situation, n);
    situation.pull_straight = false;
    const Choice stepped = StraightTo(situation, n);
    ExpectGoodPath(pulled);
    ExpectEndsAtTheCandidate(pulled);
    ExpectEndsAtTheCandidate(stepped);
    const VoxelIndex goal = candidates_[n].goals.front();
    EXPECT_EQ(map_.IndexOf(stepped.path_W.back()), goal);
    EXPECT_EQ(stepped.path_W, search_.PathFrom(map_, robot_W_, goal)) << "voxel by voxel";
    // Costs are truncated to hundredths: a diagonal step counts 1.41 voxels.
    EXPECT_NEAR(PathLength(stepped.path_W), candidates_[n].length, 0.004 * candidates_[n].length + 1e-9);
    EXPECT_LE(PathLength(pulled.path_W), PathLength(stepped.path_W) + 1e-9);
  }
}

}  // namespace
}  // namespace thalweg::explorer
