#include "services/evaluator/adapter/optimum.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "services/evaluator/adapter/outcome_json.h"
#include "services/evaluator/adapter/scene.h"

namespace thalweg::evaluator {
namespace {

using testing::HasSubstr;

/// Outcomes of runs that have only just begun, two from the same start and one from another.
std::vector<Outcome> Begun(const std::vector<std::string>& overrides = {}) {
  const Scene scene("tiny", overrides);
  std::vector<Outcome> outcomes;
  for (const int seed : {1, 1, 2}) {
    Outcome& outcome = outcomes.emplace_back();
    outcome.scenario = "tiny";
    outcome.seed = seed;
    outcome.progress.push_back({.p_W = scene.Start(seed).translation()});
  }
  return outcomes;
}

class OptimumTest : public testing::Test {
 protected:
  ~OptimumTest() override { std::filesystem::remove_all(folder_); }

  struct Added {
    std::vector<Outcome> outcomes;
    std::size_t found = 0;
    std::size_t from_cache = 0;
  };
  Added Add() {
    Added added{.outcomes = Begun(options_.overrides)};
    AddOptimum(options_, added.outcomes, {},
               [&](const Outcome&, bool from_cache) { ++(from_cache ? added.from_cache : added.found); });
    return added;
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("thalweg-optimum-" + std::to_string(getpid()));
  OptimumOptions options_{.scenarios = {"tiny"},
                          .overrides = {},
                          .tours = {.spacing = 0.4, .max_samples = 2000, .iterations = 20},
                          .cache = folder_ / "journal.optimum"};
};

TEST_F(OptimumTest, RunsFromOneStartShareItsToursWhateverTheNumberOfThreads) {
  options_.cache.clear();
  options_.threads = 1;
  const Added one = Add();
  EXPECT_EQ(one.found, 2U);
  for (const Outcome& outcome : one.outcomes) ASSERT_TRUE(outcome.optimum->to[3].length);
  EXPECT_EQ(one.outcomes[0].optimum, one.outcomes[1].optimum);
  EXPECT_NE(one.outcomes[0].optimum, one.outcomes[2].optimum);
  EXPECT_FALSE(std::filesystem::exists(folder_));
  options_.threads = 2;
  const Added two = Add();
  for (std::size_t n = 0; n < 3; ++n) EXPECT_EQ(two.outcomes[n].optimum, one.outcomes[n].optimum);
}

TEST_F(OptimumTest, ASecondEvaluationTakesThemFromTheCache) {
  const Added first = Add();
  EXPECT_EQ(first.from_cache, 0U);
  std::ofstream(options_.cache, std::ios::app) << R"({"key": "half a li)";  // killed while writing
  const Added second = Add();
  EXPECT_EQ(second.found, 0U);
  EXPECT_EQ(second.from_cache, 2U);
  for (std::size_t n = 0; n < 3; ++n) EXPECT_EQ(second.outcomes[n].optimum, first.outcomes[n].optimum);
}

TEST_F(OptimumTest, AnotherRobotSensorVoxelOrSearchIsAnotherTour) {
  Add();
  for (const char* other :
       {"robot.radius_m=0.12", "explorer.safety_margin_m=0.06", "mapper.max_range_m=2",
        "mapper.voxel_size_m=0.2", "depth_sensor.max_range_m=2.5", "world.bounds_max_m.z=1.6"}) {
    options_.overrides = {other};
    EXPECT_EQ(Add().from_cache, 0U) << other;
  }
  options_.overrides = {"explorer.time_budget_s=9"};
  EXPECT_EQ(Add().from_cache, 2U) << "no matter to a tour";
  options_.tours.iterations = 21;
  EXPECT_EQ(Add().from_cache, 0U);
}

TEST_F(OptimumTest, ToursThatRanOutOfTimeAreSearchedForAgainWithMore) {
  options_.tours.iterations = 1'000'000;
  options_.tours.budget = 1e-3;
  const Added hasty = Add();
  EXPECT_TRUE(hasty.outcomes[0].optimum->out_of_time);
  EXPECT_EQ(Add().from_cache, 2U);
  options_.tours.budget = 0.02;
  EXPECT_EQ(Add().from_cache, 0U);
}

TEST_F(OptimumTest, StoppedItAddsNone) {
  std::stop_source stop;
  stop.request_stop();
  std::vector<Outcome> outcomes = Begun();
  AddOptimum(options_, outcomes, stop.get_token());
  for (const Outcome& outcome : outcomes) EXPECT_FALSE(outcome.optimum);
}

TEST_F(OptimumTest, AStartWithoutRoomForTheClearanceHasNoTours) {
  std::vector<Outcome> outcomes = Begun();
  outcomes.resize(1);
  outcomes[0].progress[0].p_W = {0.16, 1.3, 0.8};  // 0.12 m beside the wall
  AddOptimum(options_, outcomes, {});
  EXPECT_EQ(outcomes[0].optimum, OfflineTours{});
}

TEST(OfflineToursJson, IsReadBackToTheLastBitAndRefusedWhenItIsNone) {
  OfflineTours tours;
  tours.to[0] = {.length = 1.0 / 3.0, .coverage = 0.951, .stops = 2, .path_W = {{0.1, 0.2, 0.3}, {1, 2, 3}}};
  tours.places = 7;
  tours.spacing = 0.4;
  tours.iterations = 99;
  tours.out_of_time = true;
  const auto json = nlohmann::json::parse(ToJson(tours).dump());
  EXPECT_EQ(*OfflineToursFromJson(json), tours);
  auto lacking = json;
  lacking.erase("spacing_m");
  EXPECT_THAT(OfflineToursFromJson(lacking).error(), HasSubstr("spacing_m"));
  auto other = json;
  other["tours"][1]["to"] = 0.5;
  EXPECT_THAT(OfflineToursFromJson(other).error(), HasSubstr("other coverages"));
}

}  // namespace
}  // namespace thalweg::evaluator
