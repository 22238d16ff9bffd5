#include "services/explorer/core/tight_ways.h"

#include <gtest/gtest.h>

#include "common/geometry/polyline.h"
#include "tests/services/explorer/support/knowing.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

using test::kNow;

constexpr double kFarEndArea = 1.44;  // [m^2]

/// The long room, with a wall across it that has square holes, for a robot that keeps 0.2 m.
class TightWaysTest : public testing::Test {
 protected:
  /// Makes holes from y to y + edge, which the robot sees through and does not get through.
  void MakeRoom(const std::vector<std::pair<int, int>>& holes) {
    std::vector<VoxelChange> changes = test::LongRoom();
    test::Fill(changes, {{25, 0, 0}, {26, 12, 12}}, VoxelState::kOccupied);
    for (const auto& [y, edge] : holes) {
      test::Fill(changes, {{25, y, 3}, {26, y + edge, 3 + edge}}, VoxelState::kFree);
    }
    Knowledge::Options options = test::KnowingOptions();
    options.map.clearance = 0.2;
    knowledge_ = test::Knowing(changes, options);
    test::ForEachVoxel({{60, 0, 0}, {61, 12, 12}}, [&](const VoxelIndex& i) {
      knowledge_.memory().SetAside(i, AsideReason::kOutOfSight, kNow);
    });
    search_.Flood(map(), {{map().IndexOf(robot_W_), 0}});
    ASSERT_FALSE(search_.Reached({40, 6, 6}));
  }
  const PlanningMap& map() const { return knowledge_.map(); }
  std::vector<TightWay> Find() const {
    return FindTightWays(knowledge_, search_, robot_W_, 0.1, GoalFinder(2.0, 0.1), 0.8);
  }

  Eigen::Vector3d robot_W_ = test::kHere.translation();
  Knowledge knowledge_{test::KnowingOptions()};
  PathSearch search_;
};

TEST_F(TightWaysTest, AGapThatIsWideEnoughInItsMiddleHasAPathThatKeepsTheClearance) {
  MakeRoom({{4, 4}});  // its middle keeps 0.2 m from the sides, the nearest center of a voxel 0.15 m
  const std::vector<TightWay> ways = Find();
  ASSERT_EQ(ways.size(), 1U);
  EXPECT_NEAR(ways[0].area, kFarEndArea, 1e-9);
  EXPECT_NEAR(ways[0].place_W.x(), 2.5, 0.3);
  const std::vector<Eigen::Vector3d>& path_W = ways[0].path_W;
  ASSERT_FALSE(path_W.empty());
  EXPECT_EQ(path_W.front(), robot_W_);
  EXPECT_GT(path_W.back().x(), 3.5) << "from where the far end is in sight";
  EXPECT_GE(test::SampledClearance(map(), path_W, PlanningMap::Obstacles::kOccupiedAndUnknown, 1.0),
            0.2 - 1e-6);
  EXPECT_FALSE(ways[0].nearest.unknowns.empty());
}

TEST_F(TightWaysTest, AGapThatOnlyFitsTheBodyWithoutItsMarginHasNone) {
  for (const int edge : {2, 3}) {  // 0.1 m between voxels, and 0.15 m at the center of one
    MakeRoom({{4, edge}});
    const std::vector<TightWay> ways = Find();
    ASSERT_EQ(ways.size(), 1U) << edge;
    EXPECT_TRUE(ways[0].path_W.empty());
    EXPECT_NEAR(ways[0].area, kFarEndArea, 1e-9);
  }
}

TEST_F(TightWaysTest, AGapThatTheBodyDoesNotFitIsNone) {
  MakeRoom({{4, 1}});
  EXPECT_TRUE(Find().empty());
}

TEST_F(TightWaysTest, OfTwoGapsTheWiderHasAPathAndEachClusterCountsOnce) {
  MakeRoom({{0, 3}, {8, 4}});
  double area = 0.0;
  std::size_t paths = 0;
  for (const TightWay& way : Find()) {
    area += way.area;
    paths += way.path_W.empty() ? 0U : 1U;
  }
  EXPECT_NEAR(area, kFarEndArea, 1e-9) << "each cluster counts once";
  EXPECT_GE(paths, 1U);
}

TEST_F(TightWaysTest, WithoutAMarginTheOnlyOnesAreThoseBetweenVoxels) {
  MakeRoom({{4, 3}});
  EXPECT_TRUE(FindTightWays(knowledge_, search_, robot_W_, 0.2, GoalFinder(2.0, 0.1), 0.8).empty());
  MakeRoom({{4, 4}});
  const std::vector<TightWay> ways =
      FindTightWays(knowledge_, search_, robot_W_, 0.2, GoalFinder(2.0, 0.1), 0.8);
  ASSERT_EQ(ways.size(), 1U);
  EXPECT_FALSE(ways[0].path_W.empty());
}

}  // namespace
}  // namespace thalweg::explorer
