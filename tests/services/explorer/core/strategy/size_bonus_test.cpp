#include "services/explorer/core/strategy/size_bonus.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/services/explorer/support/situations.h"

namespace thalweg::explorer {
namespace {

class SizeBonusOnRandomMaps : public test::OnRandomMaps {};
INSTANTIATE_TEST_SUITE_P(Seeds, SizeBonusOnRandomMaps, testing::Range(1U, 21U));

TEST_P(SizeBonusOnRandomMaps, TakesTheLargerOfTwoAtTheSameDistance) {
  TakeFrontiers();
  const Choice choice = SizeBonus().Choose(situation());
  const std::size_t size = candidates_[choice.candidate].cluster.unknowns.size();
  for (const Candidate& candidate : candidates_) {
    EXPECT_LE(std::min<std::size_t>(200, candidate.cluster.unknowns.size()), size);
  }
  ExpectGoodPath(choice);
}

}  // namespace
}  // namespace thalweg::explorer
