#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include "common/scenario/scenario.h"
#include "services/evaluator/adapter/scene.h"
#include "services/evaluator/core/lockstep.h"
#include "services/evaluator/text/run_end_text.h"

namespace thalweg::evaluator {
namespace {

/// The gap navigation tree in a world that is simply connected.
class GapsInTheWarren : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Starts, GapsInTheWarren, testing::Range(1, 5));

TEST_P(GapsInTheWarren, CompleteWithoutACollision) {
  const Outcome outcome = Scene("warren", {"robot.drive=DIFFERENTIAL"}).Run("gaps", GetParam());
  EXPECT_EQ(ToText(outcome.end), "complete");
  EXPECT_EQ(outcome.collisions, 0);
  EXPECT_GE(outcome.coverage, 0.97);
}

/// A shipped scenario in whose world boxes stand, as parts that move by timetables of one place.
/// @param boxes  World.moving's min_m and max_m
Scene SceneWithBoxes(const std::string& name, const std::vector<std::string>& boxes,
                     std::vector<std::string> overrides = {}) {
  const std::filesystem::path shipped = ScenarioFolder() / (name + ".txtpb");
  const std::string file = testing::TempDir() + "/" + name + "_with_boxes.txtpb";
  std::ostringstream read;
  read << std::ifstream(shipped).rdbuf();
  std::string text = read.str();
  const std::string begin = "world {";
  std::string world = begin;
  for (const std::string& box : boxes) world += " moving { " + box + " places { time_s: 0 } }";
  text.replace(text.find(begin), begin.size(), world);
  std::ofstream(file) << text;
  overrides.push_back("world.file=" +
                      (shipped.parent_path().parent_path() / ("worlds/" + name + ".obj")).string());
  return Scene(file, overrides);
}

TEST(GapsAroundAPillar, EndBecauseOfIt) {
  const Scene scene =
      SceneWithBoxes("warren", {"min_m { x: 10.1 y: 4.8 z: 0.03 } max_m { x: 10.5 y: 5.2 z: 1.9 }"});
  for (int seed = 1; seed <= 2; ++seed) {
    const Outcome outcome = scene.Run("gaps", seed);
    EXPECT_EQ(ToText(outcome.end), "the strategy does not apply");
    EXPECT_EQ(outcome.collisions, 0);
    ASSERT_TRUE(outcome.end.ending.misfit_W);
    EXPECT_LT((outcome.end.ending.misfit_W->head<2>() - Eigen::Vector2d(10.3, 5.0)).norm(), 0.15);
  }
}

/// The tiny room, divided by a wall with an opening as high as the room and 0.41 m wide. Between its voxels
/// are 0.4 m, in which no center of a voxel keeps 0.2 m from both sides.
Outcome RunInDividedRoom(double radius, bool goes) {
  return SceneWithBoxes("tiny",
                        {"min_m { x: 1.42 y: 0 z: 0 } max_m { x: 1.58 y: 1.095 z: 1.6 }",
                         "min_m { x: 1.42 y: 1.505 z: 0 } max_m { x: 1.58 y: 2.5 z: 1.6 }"},
                        {"robot.radius_m=" + std::to_string(radius),
                         std::string("explorer.loop.go_tight_ways=") + (goes ? "true" : "false")})
      .Run("closest", 0);
}
bool CrossedTheWall(const Outcome& outcome) {
  return std::ranges::any_of(outcome.progress, [](const Outcome::Progress& at) { return at.p_W.x() > 1.8; });
}

TEST(GapBetweenVoxels, IsGoneThroughBeforeTheEnd) {
  const Outcome outcome = RunInDividedRoom(0.15, true);
  EXPECT_EQ(ToText(outcome.end), "complete");
  EXPECT_TRUE(CrossedTheWall(outcome));
  EXPECT_EQ(outcome.collisions, 0);
  EXPECT_GT(outcome.least_clearance, 0.03);
}

TEST(GapBetweenVoxels, IsNamedWhereTheRobotDoesNotGoThrough) {
  for (const bool margin_fits : {true, false}) {
    const Outcome outcome = RunInDividedRoom(margin_fits ? 0.15 : 0.18, !margin_fits);
    EXPECT_EQ(ToText(outcome.end), "incomplete: too much stayed unknown");
    EXPECT_FALSE(CrossedTheWall(outcome));
    ASSERT_FALSE(outcome.end.ending.tight_ways.empty());
    const Eigen::Vector3d& place_W = outcome.end.ending.tight_ways.front().place_W;
    EXPECT_LT((place_W.head<2>() - Eigen::Vector2d(1.5, 1.3)).norm(), 0.5);
  }
}

TEST(GapsInTheFlat, EndWhereTheRobotHasFoundWhatItCanGoAround) {
  const Outcome outcome = Scene("flat_ground").Run("gaps", 1);
  EXPECT_EQ(ToText(outcome.end), "the strategy does not apply");
  ASSERT_TRUE(outcome.end.ending.misfit_W);
  const Eigen::Vector3d& place_W = *outcome.end.ending.misfit_W;
  EXPECT_LT(Scene("flat_ground").world().DistanceToSurface(place_W, 1.0), 0.5) << "something stands there";
}

Outcome RiftRunIn(const char* scenario, int views, MotionModel motion = MotionModel::kKinematic) {
  return Scene(scenario, {"explorer.rift.most_views=" + std::to_string(views)})
      .Run("rift", 1, PoseSource::kTruth, {}, false, motion);
}

TEST(RiftInTheKitchen, LooksFromWhereTheMapLetsItWithoutACollisionTwiceTheSame) {
  // From the depth sensor, and from matched pixels
  for (const auto& [scenario, views] : {std::pair("kitchen", 9), std::pair("kitchen_stereo", 3)}) {
    const Outcome outcome = RiftRunIn(scenario, views);
    EXPECT_EQ(NameOf(outcome.end), "strategy_cannot_go_on");
    EXPECT_EQ(outcome.end.ending.why,
              "it keeps " + std::to_string(views) + " views, as many as it may (rift.most_views)");
    EXPECT_EQ(outcome.collisions, 0);
    EXPECT_GT(outcome.distance, 1.0);
    EXPECT_GT(outcome.left_out, 0U);
    EXPECT_EQ(outcome.left_out, outcome.end.ending.left_out);
    const Outcome again = RiftRunIn(scenario, views);
    EXPECT_EQ(again.distance, outcome.distance);
    EXPECT_EQ(again.plans, outcome.plans);
    EXPECT_EQ(again.left_out, outcome.left_out);
    EXPECT_EQ(again.coverage, outcome.coverage);
  }
}

TEST(RiftInTheKitchen, GoesAsWellWhereTheControllerLeads) {
  const Outcome outcome = RiftRunIn("kitchen", 9, MotionModel::kDynamic);
  EXPECT_EQ(NameOf(outcome.end), "strategy_cannot_go_on");
  EXPECT_EQ(outcome.collisions, 0);
  EXPECT_GT(outcome.distance, 1.0);
}

TEST(RiftInTheTinyRoom, EndsAtOnceWhereTheFirstViewHasNoRift) {
  const Outcome outcome = RiftRunIn("tiny_stereo", 9);
  EXPECT_EQ(ToText(outcome.end), "incomplete: too much stayed unknown, no rift is left");
  EXPECT_EQ(outcome.plans, 1U);
}

}  // namespace
}  // namespace thalweg::evaluator
