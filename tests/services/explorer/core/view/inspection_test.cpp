#include "services/explorer/core/view/inspection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "services/explorer/core/map/frontier.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// A robot in a random scene.
class InspectionTest : public testing::TestWithParam<unsigned> {
 protected:
  InspectionTest() {
    surface_.Follow(map_, map_.Apply(test::RandomScene(random_, {{0, 0, 0}, {30, 26, 20}}, 12, 5)));
    std::vector<VoxelIndex> traversable;
    test::ForEachVoxel(map_.box(), [&](const VoxelIndex& i) {
      if (map_.Traversable(i)) traversable.push_back(i);
    });
    Stand(traversable.at(random_() % traversable.size()), Eigen::Matrix3d::Identity());
  }
  void Stand(const VoxelIndex& at, const Eigen::Matrix3d& R_WB) {
    T_WB_ = MakeTransform(R_WB, map_.CenterOf(at));
    search_.Flood(map_, {{at, 0}});
  }
  std::optional<InspectionView> Best(InspectionPlanner& planner, double max_length = kFar) {
    return planner.Best(map_, search_, views_, T_WB_, max_length, surface_);
  }
  void Take(const InspectionView& view) {
    Stand(view.place, view.R_WB);
    surface_.See(map_, {.T_WC = MakeTransform(view.R_WB * BodyFromOptical(), T_WB_.translation())});
  }
  /// Takes views until none is worth it. @return Number of views.
  int TakeAll(InspectionPlanner& planner) {
    for (int n = 0;; ++n) {
      const std::optional<InspectionView> view = Best(planner);
      if (!view) return n;
      Take(*view);
    }
  }
  /// Facets that are open and can be inspected from a place, by brute force.
  std::size_t CountFrom(const VoxelIndex& place) {
    std::size_t count = 0;
    for (const Facet& facet : surface_.OpenFacets(map_))
      count += surface_.InspectableFrom(map_, map_.CenterOf(place), facet) ? 1 : 0;
    return count;
  }
  double WorthOf(const VoxelIndex& place) {
    return static_cast<double>(CountFrom(place)) / (search_.Length(place) + options_.stop_cost);
  }

  std::mt19937 random_{GetParam()};
  PlanningMap map_{{.voxel_size = 0.1, .clearance = 0.15, .bounds = {}}};
  PinholeCamera camera_ = PinholeCamera::FromFieldOfView(100, 100, 90 * kDegree);
  ViewPlanner views_{camera_, BodyFromOptical()};
  InspectionOptions options_{.criterion = {.distance = 1.2}, .min_area = 0.1};
  std::size_t enough_ = VoxelsOfArea(options_.min_area, 0.1);
  InspectedSurface surface_{options_.criterion, camera_, 0.0};
  PathSearch search_;
  RigidTransform T_WB_ = RigidTransform::Identity();
};
INSTANTIATE_TEST_SUITE_P(Seeds, InspectionTest, testing::Range(1U, 7U));

TEST_P(InspectionTest, NoPlaceInspectsMorePerMeterAndAViewShowsWhatItPromises) {
  InspectionPlanner planner(options_);
  std::size_t moves = 0;
  while (const std::optional<InspectionView> view = Best(planner)) {
    InspectionPlanner forgetful(options_);
    const std::optional<InspectionView> same = Best(forgetful);
    ASSERT_TRUE(same);
    EXPECT_EQ(same->place, view->place) << "what is remembered of earlier calls changes nothing";
    ASSERT_EQ(same->facets, view->facets);
    ASSERT_TRUE(search_.Reached(view->place));
    EXPECT_GE(view->facets.size(), enough_);
    if (view->length > 0.0 && ++moves % 4 == 1) {
      // In a cell that is reached as a whole, the place is the first of the eight in its middle.
      test::ForEachVoxel(map_.box(), [&](const VoxelIndex& i) {
        if (i.x % 4 != 1 || i.y % 4 != 1 || i.z % 4 != 1 || !search_.Reached(i)) return;
        // One view of four or more shows enough of so much.
        if (CountFrom(i) < 8 * enough_) return;
        EXPECT_LE(WorthOf(i), WorthOf(view->place) + 1e-9);
      });
    }
    Take(*view);
    const auto open =
        std::ranges::count_if(view->facets, [&](const Facet& facet) { return surface_.Open(map_, facet); });
    EXPECT_LE(static_cast<double>(open), 0.05 * static_cast<double>(view->facets.size()))
        << "rounding decides on the image's edge, and nowhere else";
  }
  EXPECT_GT(moves, 2U);
}

TEST_P(InspectionTest, AChangeOfTheMapIsNotOverlooked) {
  InspectionPlanner planner(options_);
  EXPECT_GT(TakeAll(planner), 0);
  // A board before the robot, where there was free space.
  const VoxelIndex low = map_.IndexOf(T_WB_.translation()) + VoxelIndex{4, -2, -2};
  const VoxelBox board{low, low + VoxelIndex{1, 5, 5}};
  surface_.Follow(map_, map_.Apply(test::BoxOf(board, VoxelState::kOccupied)));
  Stand(map_.IndexOf(T_WB_.translation()), T_WB_.linear());
  InspectionPlanner forgetful(options_);
  const std::optional<InspectionView> expected = Best(forgetful);
  const std::optional<InspectionView> view = Best(planner);
  ASSERT_EQ(view.has_value(), expected.has_value());
  if (!view) return;
  EXPECT_EQ(view->place, expected->place);
}

TEST_P(InspectionTest, PlacesBeyondTheGreatestLengthAreNotTried) {
  InspectionPlanner planner(options_);
  for (int n = 0; n < 10; ++n) {
    const std::optional<InspectionView> view = Best(planner, 0.8);
    if (!view) break;
    EXPECT_LE(view->length, 0.8);
    Take(*view);
  }
}

}  // namespace
}  // namespace thalweg::explorer
