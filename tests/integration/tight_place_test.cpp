#include <gtest/gtest.h>

#include <random>

#include "services/controller/core/path_check.h"
#include "services/explorer/core/path/path_search.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg {
namespace {

using explorer::PathSearch;
using explorer::PlanningMap;

/// What moves: the explorer's options of it, and the controller's.
struct Body {
  double height;  ///< [m] 0 = a sphere.
  bool drives;
};

class TightPlace : public testing::TestWithParam<std::tuple<unsigned, Body>> {};
INSTANTIATE_TEST_SUITE_P(Seeds, TightPlace,
                         testing::Combine(testing::Range(1U, 5U),
                                          testing::Values(Body{0.0, false}, Body{0.3, false},
                                                          Body{0.3, true})),
                         [](const auto& combination) {
                           const Body& body = std::get<1>(combination.param);
                           return std::string(body.drives         ? "Driving"
                                              : body.height > 0.0 ? "Cylinder"
                                                                  : "Sphere") +
                                  std::to_string(std::get<0>(combination.param));
                         });

/// Every way out of a place where the body touches something, as the explorer plans it, is one that the
/// controller flies, however far the robot has come on it when the map changes elsewhere.
TEST_P(TightPlace, TheControllerFliesEveryWayOutThatTheExplorerPlans) {
  constexpr double kRadius = 0.14;
  constexpr double kMargin = 0.01;
  const auto [seed, body] = GetParam();
  std::mt19937 random(seed);
  PlanningMap planned({.voxel_size = 0.1,
                       .clearance = kRadius + kMargin,
                       .half_height = body.height > 0.0 ? 0.5 * body.height + kMargin : 0.0,
                       .bounds = {}});
  if (body.drives) planned.SetPlane(0.65);
  const std::vector<VoxelChange> scene = explorer::test::RandomScene(random, {{0, 0, 0}, {30, 30, 14}}, 30, 4);
  planned.Apply(scene);
  OccupancyGrid known(0.1);
  for (const VoxelChange& change : scene) known.Set(change.voxel, change.log_odds);
  controller::PathCheck check({.radius = kRadius, .height = body.height, .drives = body.drives});

  const Eigen::AlignedBox3d inside(Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(3.0, 3.0, 1.4));
  std::size_t ways = 0;
  std::size_t tight = 0;
  for (int n = 0; n < 400; ++n) {
    Eigen::Vector3d p_W = explorer::test::RandomPoint(random, inside);
    if (body.drives) p_W.z() = 0.65;
    if (planned.State(planned.IndexOf(p_W)) != VoxelState::kFree) continue;
    if (planned.ClearanceAt(p_W, PlanningMap::Obstacles::kOccupied, kRadius) >= kRadius) continue;
    ++tight;
    for (const auto& entry : PathSearch::StartAt(planned, p_W, kRadius, {1.0, true})) {
      ++ways;
      const controller::Track way({MakeTransform(Eigen::Matrix3d::Identity(), p_W),
                                   MakeTransform(Eigen::Matrix3d::Identity(), planned.CenterOf(entry.voxel))},
                                  {});
      for (const double share : {0.0, 0.3, 0.7}) {
        check.Restart(known, way, share * way.length());
        while (!check.obstacle_W() && check.clear_to() < way.length()) check.Continue(known, way);
        ASSERT_FALSE(check.obstacle_W())
            << p_W.transpose() << " to " << planned.CenterOf(entry.voxel).transpose() << " at "
            << check.obstacle_W()->transpose();
      }
    }
  }
  EXPECT_GT(tight, 10U);
  EXPECT_GT(ways, 100U);
}

}  // namespace
}  // namespace thalweg
