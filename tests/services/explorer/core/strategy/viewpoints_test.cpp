#include "services/explorer/core/strategy/viewpoints.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/services/explorer/support/situations.h"

namespace thalweg::explorer {
namespace {

using test::kLookRange;
using test::kViews;

class ViewpointsOnRandomMaps : public test::OnRandomMaps {};
INSTANTIATE_TEST_SUITE_P(Seeds, ViewpointsOnRandomMaps, testing::Range(1U, 21U));

TEST_P(ViewpointsOnRandomMaps, SeeThreeQuartersOfWhatTheGoalSees) {
  const DenseGrid<std::uint8_t> none(map_.box(), 0);
  const std::vector<VoxelIndex> traversable = test::TraversableVoxels(map_);
  const auto sees = [&](const VoxelIndex& from, const VoxelIndex& unknown) {
    const Eigen::Vector3d p_W = map_.CenterOf(from);
    const Eigen::Vector3d q_W = map_.CenterOf(unknown);
    return (p_W - q_W).norm() <= kLookRange && kViews.CanShow(q_W - p_W) && map_.InSight(p_W, q_W);
  };
  for (Cluster& cluster : FindFrontiers(map_, none, {}).clusters) {
    // this many are all looked at
    cluster.unknowns.resize(std::min<std::size_t>(cluster.unknowns.size(), 6));
    // Any position that sees some of it may be its goal.
    const auto goal = std::find_if(traversable.begin(), traversable.end(), [&](const VoxelIndex& i) {
      return search_.Reached(i) && sees(i, cluster.unknowns.front());
    });
    if (goal == traversable.end()) continue;
    const auto seen_from = [&](const VoxelIndex& place) {
      return std::count_if(cluster.unknowns.begin(), cluster.unknowns.end(),
                           [&](const VoxelIndex& i) { return sees(*goal, i) && sees(place, i); });
    };
    candidates_ = {{.cluster = cluster, .goals = {*goal}, .length = search_.Length(*goal)}};
    const Situation here = situation();
    Viewpoints viewpoints(here);
    for (std::size_t n = 0; n < traversable.size(); n += 17) {
      EXPECT_EQ(viewpoints.SeesEnough(traversable[n], 0),
                4 * seen_from(traversable[n]) >= 3 * seen_from(*goal));
    }
    const std::vector<VoxelIndex> places = viewpoints.PlacesFor(
        0, viewpoints.PlacesBefore(0), [&](const VoxelIndex& i) { return search_.Cost(i); });
    EXPECT_EQ(places.front(), *goal);
    for (std::size_t n = 1; n < places.size(); ++n) {
      EXPECT_TRUE(search_.Reached(places[n]));
      EXPECT_GE(4 * seen_from(places[n]), 3 * seen_from(*goal));
      if (n > 1) {
        EXPECT_GE(search_.Cost(places[n]), search_.Cost(places[n - 1]));
      }
    }
  }
}

}  // namespace
}  // namespace thalweg::explorer
