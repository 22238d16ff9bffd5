#include "services/explorer/core/strategy/information_gain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "services/explorer/core/view/sensor_gain.h"
#include "tests/services/explorer/support/situations.h"

namespace thalweg::explorer {
namespace {

using test::kSensorRange;
using test::kSize;
using test::kViews;

class InformationGainOnRandomMaps : public test::OnRandomMaps {};
INSTANTIATE_TEST_SUITE_P(Seeds, InformationGainOnRandomMaps, testing::Range(1U, 21U));

TEST_P(InformationGainOnRandomMaps, GoesWhereBruteForceFindsMost) {
  TakeFrontiers();
  std::vector<VoxelIndex> targets;
  for (const Candidate& candidate : candidates_) {
    targets.insert(targets.end(), candidate.cluster.unknowns.begin(), candidate.cluster.unknowns.end());
  }
  constexpr double kShare = 0.2;
  for (const double decay : {0.0, 0.2, 2.0}) {
    SensorGain gain(kViews, kSize, kSensorRange);
    gain.Follow(map_, targets);
    double best = 0.0;
    for (const VoxelIndex& i : test::TraversableVoxels(map_)) {
      if (!InformationGain::Sampled(i, kShare) || !search_.Reached(i)) continue;
      best = std::max(best, gain.BestView(i).value * std::exp(-decay * search_.Length(i)));
    }
    InformationGain strategy({.sample_share = kShare, .decay = decay}, decay);
    const Choice choice = strategy.Choose(situation());
    const VoxelIndex place = map_.IndexOf(choice.path_W.back());
    EXPECT_TRUE(InformationGain::Sampled(place, kShare));
    EXPECT_EQ(gain.BestView(place).value * std::exp(-decay * search_.Length(place)), best);
    EXPECT_EQ(choice.target, gain.BestView(place).seen);
    ExpectGoodPath(choice);
  }
}

TEST(InformationGain, SamplesTheShareOfVoxelsThatWasAskedFor) {
  for (const double share : {0.05, 0.3}) {
    int sampled = 0;
    test::ForEachVoxel({{-20, -20, -20}, {20, 20, 20}},
                       [&](const VoxelIndex& i) { sampled += InformationGain::Sampled(i, share) ? 1 : 0; });
    EXPECT_NEAR(sampled / 64000.0, share, 0.005);
  }
}

}  // namespace
}  // namespace thalweg::explorer
