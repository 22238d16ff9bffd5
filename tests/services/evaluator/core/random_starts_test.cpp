#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "tests/services/evaluator/core/shipped_scene.h"

namespace thalweg::evaluator {
namespace {

/// A whole exploration of a shipped scene from a random start.
class RandomStarts : public testing::TestWithParam<std::tuple<const char*, int>> {
 protected:
  void Explore(const std::string& scene_name) {
    const auto [strategy, seed] = GetParam();
    const test::ShippedScene scene(scene_name);
    const LockstepOptions options = scene.Options(strategy);
    mapper::OccupancyMap map(options.mapper);
    const RigidTransform start = scene.Start(seed);
    const LockstepResult result = RunLockstep(scene.world(), start, options, map);
    const double coverage = scene.Truth(start.translation()).Compare(map.grid()).coverage();
    RecordProperty("distance_m", std::to_string(result.distance));
    RecordProperty("coverage", std::to_string(coverage));
    RecordProperty("least_clearance_m", std::to_string(result.least_clearance));
    EXPECT_EQ(result.stop_reason, "complete");
    EXPECT_EQ(result.collisions, 0);
    EXPECT_GE(coverage, 0.97);
  }
};

class Kitchen : public RandomStarts {};
TEST_P(Kitchen, IsExploredCompletelyWithoutACollision) {
  Explore("kitchen");
}
INSTANTIATE_TEST_SUITE_P(Starts, Kitchen,
                         testing::Combine(testing::Values("closest", "potential"), testing::Range(1, 11)));

class Flat : public RandomStarts {};
TEST_P(Flat, IsExploredCompletelyWithoutACollision) {
  Explore("flat");
}
INSTANTIATE_TEST_SUITE_P(Starts, Flat,
                         testing::Combine(testing::Values("closest", "potential"), testing::Range(1, 4)));

}  // namespace
}  // namespace thalweg::evaluator
