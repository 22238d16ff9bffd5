#include "services/explorer/core/strategy/closest.h"

#include <gtest/gtest.h>

#include "tests/services/explorer/support/situations.h"

namespace thalweg::explorer {
namespace {

class ClosestOnRandomMaps : public test::OnRandomMaps {};
INSTANTIATE_TEST_SUITE_P(Seeds, ClosestOnRandomMaps, testing::Range(1U, 21U));

TEST_P(ClosestOnRandomMaps, TakesTheShortestPath) {
  const Choice choice = Closest().Choose(situation());
  EXPECT_EQ(choice.candidate, Nearest());
  // Costs are truncated to hundredths: a diagonal step counts 1.41 voxels.
  EXPECT_LE(PathLength(choice.path_W), 1.004 * candidates_[choice.candidate].length + 1e-9);
  ExpectGoodPath(choice);
  ExpectEndsAtTheCandidate(choice);
}

}  // namespace
}  // namespace thalweg::explorer
