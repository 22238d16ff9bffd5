#include "services/explorer/core/strategy/inspection_tour.h"

#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <stdexcept>
#include <vector>

#include "services/explorer/core/map/frontier.h"
#include "tests/services/explorer/support/inspected_scene.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

/// A view of a test's scene as the tour has it next.
std::optional<InspectionView> NextOf(InspectionTour& tour, test::InspectedScene& scene,
                                     const std::optional<VoxelIndex>& frontier = {}) {
  return tour.Next(scene.Views(), scene.search, scene.T_WB, frontier);
}

class InspectionTourTest : public testing::TestWithParam<unsigned> {
 protected:
  /// Takes views until there is no next one, at most 500.
  std::vector<InspectionView> TakeAll(const InspectionOptions& options) {
    InspectionTour tour(options);
    std::vector<InspectionView> taken;
    while (taken.size() < 500) {
      const auto view = NextOf(tour, scene_);
      if (!view) break;
      taken.push_back(*view);
      scene_.Take(*view);
      for (const Facet& facet : view->facets) scene_.surface.CountTry(facet);
    }
    return taken;
  }
  /// Facets that are open and that some reached voxel can inspect.
  std::size_t CountLeft() {
    const InspectionViews views = scene_.Views();
    std::size_t left = 0;
    for (const Facet& facet : views.open()) {
      bool can = false;
      test::ForEachVoxel(scene_.map.box(), [&](const VoxelIndex& i) {
        can = can || (scene_.search.Reached(i) && views.CanInspect(i, facet));
      });
      left += can ? 1 : 0;
    }
    return left;
  }

  test::InspectedScene scene_{GetParam()};
  InspectionOptions any_{.criterion = scene_.criterion,
                         .min_area = 0.05,
                         .least_strip = 0.0,
                         .eagerness = 2.0,
                         .stop_cost = 0.3};
};
INSTANTIATE_TEST_SUITE_P(Seeds, InspectionTourTest, testing::Range(1U, 7U));

TEST_P(InspectionTourTest, LeavesHardlyAnythingWhereAnyAreaIsWorthItsPath) {
  const std::size_t before = CountLeft();
  const std::vector<InspectionView> taken = TakeAll(any_);
  EXPECT_LT(taken.size(), 500U);
  EXPECT_GT(taken.size(), 5U);
  EXPECT_GT(before, 200U);
  EXPECT_LE(static_cast<double>(CountLeft()), 0.08 * static_cast<double>(before))
      << "a stop is chosen for the middles of patches, not for their edges";
}

TEST_P(InspectionTourTest, GoesNowhereForLessThanIsWorthThePath) {
  InspectionOptions picky = any_;
  picky.least_strip = 1000.0;
  for (const InspectionView& view : TakeAll(picky)) EXPECT_EQ(view.length, 0.0) << "only turns are worth it";
}

TEST_P(InspectionTourTest, BeginsWithWhatATurnInspects) {
  InspectionTour tour(any_);
  const std::size_t enough = VoxelsOfArea(any_.min_area, scene_.map.voxel_size());
  for (int n = 0; n < 20; ++n) {
    const VoxelIndex here = scene_.map.IndexOf(scene_.T_WB.translation());
    const auto turn = scene_.Views().Best(here, scene_.T_WB.linear(), enough);
    const auto view = NextOf(tour, scene_);
    if (!view) break;
    EXPECT_EQ(view->length == 0.0, turn.has_value());
    EXPECT_EQ(view->place == here, turn.has_value());
    if (turn) {
      EXPECT_EQ(view->facets, turn->facets);
    }
    scene_.Take(*view);
  }
}

TEST_P(InspectionTourTest, IsTheSameForTheSameCalls) {
  InspectionTour a(any_);
  InspectionTour b(any_);
  for (int n = 0; n < 20; ++n) {
    const auto view = NextOf(a, scene_);
    const auto same = NextOf(b, scene_);
    ASSERT_EQ(view.has_value(), same.has_value());
    if (!view) break;
    EXPECT_EQ(view->place, same->place);
    EXPECT_EQ(view->facets, same->facets);
    EXPECT_NEAR(view->length, scene_.search.Length(view->place), 1e-9);
    scene_.Take(*view);
  }
}

/// A corridor 10 m long, with a robot in the middle, 0.5 m from the nearest walls, that has inspected all
/// but the parts that a test leaves open.
class CorridorTourTest : public testing::Test {
 protected:
  static constexpr int kLength = 100;  // [voxels] And 12 wide and high.
  CorridorTourTest() {
    std::vector<VoxelChange> changes;
    test::ForEachVoxel({{0, 0, 0}, {kLength, 12, 12}}, [&](const VoxelIndex& i) {
      const bool inside = i.x > 0 && i.x < kLength - 1 && i.y > 0 && i.y < 11 && i.z > 0 && i.z < 11;
      changes.push_back({i, inside ? test::kFreeLogOdds : test::kOccupiedLogOdds});
    });
    surface_.Follow(map_, map_.Apply(changes));
    search_.Flood(map_, {{{50, 6, 6}, 0}});
  }
  /// Leaves only the facets open whose x [voxels] is in [begin, end).
  void LeaveOpen(const std::function<bool(int x)>& open) {
    for (const Facet& facet : surface_.OpenFacets(map_)) {
      if (open(facet.voxel.x)) continue;
      surface_.CountTry(facet);
      surface_.CountTry(facet);
    }
  }
  std::optional<InspectionView> Next(const std::optional<VoxelIndex>& frontier) {
    InspectionTour tour(options_);
    const InspectionViews views(map_, views_, options_.criterion, surface_);
    return tour.Next(views, search_, MakeTransform(Eigen::Matrix3d::Identity(), map_.CenterOf({50, 6, 6})),
                     frontier);
  }

  InspectionOptions options_{.criterion = {.distance = 1.2}};
  PlanningMap map_{{.voxel_size = 0.1, .clearance = 0.15, .bounds = {}}};
  PinholeCamera camera_ = PinholeCamera::FromFieldOfView(100, 100, 90 * kDegree);
  ViewPlanner views_{camera_, RobotModel{}};
  InspectedSurface surface_{options_.criterion, camera_, 0.0};
  PathSearch search_;
};

TEST_F(CorridorTourTest, InspectsOnItsWayToAFrontier) {
  LeaveOpen([](int x) { return x >= 70 && x < 75; });
  const auto view = Next(VoxelIndex{95, 6, 6});
  ASSERT_TRUE(view);
  EXPECT_NEAR(map_.CenterOf(view->place).x(), 7.25, 1.0);
}

TEST_F(CorridorTourTest, GoesToAFrontierFirstWhenSurfaceIsTheOtherWay) {
  LeaveOpen([](int x) { return x >= 5 && x < 10; });
  EXPECT_FALSE(Next(VoxelIndex{65, 6, 6})) << "1.5 m away, where the surface is 4 m away";
  const auto view = Next(std::nullopt);
  ASSERT_TRUE(view) << "without a frontier, the surface is next";
  EXPECT_LT(map_.CenterOf(view->place).x(), 2.0);
  EXPECT_NEAR(view->length, search_.Length(view->place), 1e-9);
}

TEST_F(CorridorTourTest, DoesNotGoAndComeBackForWhatLiesBesideItsWay) {
  // Open at both ends: with a frontier at one of them, that end is left for the way there.
  LeaveOpen([](int x) { return x >= 25 && x < 30; });
  const auto near = Next(VoxelIndex{95, 6, 6});
  ASSERT_TRUE(near) << "2 m against the way, once, in place of the whole way back";
  EXPECT_LT(map_.CenterOf(near->place).x(), 4.0);
}

TEST_F(CorridorTourTest, NothingOpenIsNothingToDo) {
  LeaveOpen([](int) { return false; });
  EXPECT_FALSE(Next(std::nullopt));
  EXPECT_FALSE(Next(VoxelIndex{65, 6, 6}));
}

TEST(InspectionTour, RefusesOptionsBelowZero) {
  for (double InspectionOptions::*option : {&InspectionOptions::min_area, &InspectionOptions::least_strip,
                                            &InspectionOptions::eagerness, &InspectionOptions::stop_cost}) {
    InspectionOptions options;
    options.*option = -0.1;
    EXPECT_THROW(InspectionTour{options}, std::invalid_argument);
  }
}

}  // namespace
}  // namespace thalweg::explorer
