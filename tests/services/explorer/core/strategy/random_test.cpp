#include "services/explorer/core/strategy/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <vector>

#include "tests/services/explorer/support/situations.h"

namespace thalweg::explorer {
namespace {

class RandomOnRandomMaps : public test::OnRandomMaps {};
INSTANTIATE_TEST_SUITE_P(Seeds, RandomOnRandomMaps, testing::Range(1U, 21U));

TEST_P(RandomOnRandomMaps, DrawsTheSameAgainFromTheSameSeed) {
  TakeFrontiers();
  const auto draws = [&](std::uint32_t seed) {
    Random strategy({.seed = seed});
    std::vector<std::size_t> drawn;
    for (int n = 0; n < 40; ++n) drawn.push_back(strategy.Choose(situation()).candidate);
    return drawn;
  };
  EXPECT_EQ(draws(3), draws(3));
  EXPECT_NE(draws(3), draws(4));
}

TEST_P(RandomOnRandomMaps, DrawsEveryUnknownVoxelAsOften) {
  TakeFrontiers();
  std::size_t voxels = 0;
  for (const Candidate& candidate : candidates_) voxels += candidate.cluster.unknowns.size();
  Random strategy({});
  std::map<std::size_t, int> drawn;
  constexpr int kDraws = 4000;
  for (int n = 0; n < kDraws; ++n) ++drawn[strategy.Choose(situation()).candidate];
  for (std::size_t n = 0; n < candidates_.size(); ++n) {
    const double share =
        static_cast<double>(candidates_[n].cluster.unknowns.size()) / static_cast<double>(voxels);
    const double spread = std::sqrt(kDraws * share * (1.0 - share));
    EXPECT_NEAR(drawn[n], kDraws * share, 5.0 * spread + 1.0);
  }
}

}  // namespace
}  // namespace thalweg::explorer
