#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "services/evaluator/adapter/scene.h"
#include "services/evaluator/text/run_end_text.h"

namespace thalweg::evaluator {
namespace {

/// A whole exploration of a shipped scene from a random start.
class RandomStarts : public testing::TestWithParam<std::tuple<const char*, int>> {
 protected:
  void Explore(const std::string& scene_name) {
    const auto [strategy, seed] = GetParam();
    const Outcome outcome = Scene(scene_name).Run(strategy, seed);
    RecordProperty("distance_m", std::to_string(outcome.distance));
    RecordProperty("coverage", std::to_string(outcome.coverage));
    RecordProperty("least_clearance_m", std::to_string(outcome.least_clearance));
    EXPECT_EQ(ToText(outcome.end), "complete");
    EXPECT_EQ(outcome.collisions, 0);
    EXPECT_GE(outcome.coverage, 0.97);
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

class World : public testing::TestWithParam<const char*> {};
TEST_P(World, IsExploredCompletelyWithoutACollision) {
  const Outcome outcome = Scene(GetParam()).Run("closest", 1);
  EXPECT_EQ(ToText(outcome.end), "complete");
  EXPECT_EQ(outcome.collisions, 0);
  EXPECT_GE(outcome.coverage, 0.99);
}
INSTANTIATE_TEST_SUITE_P(Shipped, World,
                         testing::Values("car", "gallery", "hall", "garage", "office", "maze", "bridge",
                                         "comb", "open_hall", "shaft"));

}  // namespace
}  // namespace thalweg::evaluator
