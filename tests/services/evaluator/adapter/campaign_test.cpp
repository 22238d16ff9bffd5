#include "services/evaluator/adapter/campaign.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "services/evaluator/adapter/outcome_json.h"
#include "services/evaluator/text/run_end_text.h"

namespace thalweg::evaluator {
namespace {

using testing::HasSubstr;

/// The outcome as JSON, without the fields that depend on a clock.
std::string Repeatable(const Outcome& outcome) {
  auto json = ToJson(outcome);
  json.erase("timings_ms");
  json.erase("wall_s");
  json.erase("cpu_s");
  return json.dump();
}

std::vector<std::string> Repeatable(const std::vector<Outcome>& outcomes) {
  std::vector<std::string> texts;
  for (const Outcome& outcome : outcomes) texts.push_back(Repeatable(outcome));
  return texts;
}

class CampaignTest : public testing::Test {
 protected:
  CampaignTest() { options_.journal = folder_ / "journal"; }
  ~CampaignTest() override { std::filesystem::remove_all(folder_); }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("thalweg-campaign-" + std::to_string(getpid()));
  Campaign::Options options_{.scenarios = {"tiny"},
                             .overrides = {"depth_sensor.disparity_noise_px=0.2"},
                             .strategies = {"closest", "potential"},
                             .runs = 3,
                             .journal = {}};
};

TEST_F(CampaignTest, TheSameSeedGivesTheSameRunsWhateverTheNumberOfThreads) {
  options_.journal.clear();
  options_.threads = 1;
  const auto one = Repeatable(Campaign(options_).Run({}));
  options_.threads = 3;
  EXPECT_EQ(Repeatable(Campaign(options_).Run({})), one);
  options_.seed = 2;
  EXPECT_NE(Repeatable(Campaign(options_).Run({})), one);
}

TEST_F(CampaignTest, StartsArePairedAcrossStrategies) {
  const std::vector<Outcome> outcomes = Campaign(options_).Run({});
  ASSERT_EQ(outcomes.size(), 6U);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_EQ(outcomes[n].strategy, "closest");
    EXPECT_EQ(outcomes[n + 3].strategy, "potential");
    EXPECT_EQ(outcomes[n].run, outcomes[n + 3].run);
    EXPECT_EQ(outcomes[n].progress.front().p_W, outcomes[n + 3].progress.front().p_W);
    EXPECT_EQ(outcomes[n].progress.front().coverage, outcomes[n + 3].progress.front().coverage);
  }
  EXPECT_NE(outcomes[0].progress.front().p_W, outcomes[1].progress.front().p_W);
}

TEST_F(CampaignTest, RunsWithTheTruthAndWithOdometryStartAlike) {
  options_.overrides = {"stereo_camera.width_px=128", "stereo_camera.height_px=96", "stereo_camera.rate_hz=5",
                        "explorer.time_budget_s=1"};
  options_.strategies = {"closest"};
  options_.poses = {PoseSource::kTruth, PoseSource::kOdometry};
  options_.runs = 1;
  const std::vector<Outcome> outcomes = Campaign(options_).Run({});
  ASSERT_EQ(outcomes.size(), 2U);
  EXPECT_EQ(outcomes[0].strategy, "closest");
  EXPECT_EQ(outcomes[1].strategy, "closest, odometry");
  EXPECT_FALSE(outcomes[0].own_pose);
  ASSERT_TRUE(outcomes[1].own_pose);
  EXPECT_GT(outcomes[1].own_pose->frames, 4U);
  EXPECT_EQ(outcomes[0].progress.front().p_W, outcomes[1].progress.front().p_W);
  EXPECT_EQ(Campaign(options_).resumed(), 2U);
  const auto json = nlohmann::json::parse(ToJson(outcomes[1]).dump());
  EXPECT_EQ(OutcomeFromJson(json)->own_pose, outcomes[1].own_pose);
}

TEST_F(CampaignTest, RunsWithNoiseAreLikenedToWhatTheirScansShowWithoutIt) {
  options_.strategies = {"closest"};
  options_.runs = 1;
  options_.overrides.clear();
  EXPECT_FALSE(Campaign(options_).Run({}).front().likeness);
  options_.overrides = {"depth_sensor.image_noise_px=1"};
  const Outcome noisy = Campaign(options_).Run({}).front();
  ASSERT_TRUE(noisy.likeness);
  EXPECT_GT(*noisy.likeness, 0.5);
  EXPECT_LT(*noisy.likeness, 0.99);
  EXPECT_EQ(OutcomeFromJson(nlohmann::json::parse(ToJson(noisy).dump()))->likeness, noisy.likeness);
}

TEST_F(CampaignTest, DynamicRunsAreKeptApartAndHaveTheirMotionInTheJournal) {
  options_.strategies = {"closest"};
  options_.runs = 1;
  const std::vector<Outcome> kinematic = Campaign(options_).Run({});
  options_.motion = MotionModel::kDynamic;
  Campaign campaign(options_);
  EXPECT_EQ(campaign.resumed(), 0U);
  const std::vector<Outcome> dynamic = campaign.Run({});
  EXPECT_GT(dynamic.front().duration, kinematic.front().duration);
  EXPECT_LT(dynamic.front().motion.most_acceleration, kinematic.front().motion.most_acceleration);
  const MotionFigures& motion = dynamic.front().motion;
  EXPECT_NEAR(motion.moving + motion.turning + motion.standing, dynamic.front().duration, 1e-6);
  EXPECT_GT(motion.stops, 0U);
  const auto again = Campaign(options_);
  ASSERT_EQ(again.resumed(), 1U);
  EXPECT_EQ(Repeatable(again.Outcomes()), Repeatable(dynamic));
  options_.poses = {PoseSource::kOdometry};
  EXPECT_THROW(Campaign{options_}, std::invalid_argument);
}

TEST_F(CampaignTest, OneThatWasBrokenOffGoesOnAndEndsWithTheSame) {
  std::stop_source stop;
  options_.threads = 1;
  const auto some = Campaign(options_).Run(stop.get_token(), [&](const Outcome&, std::size_t made) {
    if (made == 2) stop.request_stop();
  });
  EXPECT_EQ(some.size(), 2U);
  std::ofstream(options_.journal, std::ios::app) << R"({"key": "half a li)";  // killed while writing
  Campaign again(options_);
  EXPECT_EQ(again.resumed(), 2U);
  std::size_t reported = 0;
  const auto all = again.Run({}, [&](const Outcome&, std::size_t) { ++reported; });
  EXPECT_EQ(reported, 4U);
  EXPECT_EQ(Campaign(options_).resumed(), 6U);
  options_.journal.clear();
  EXPECT_EQ(Repeatable(all), Repeatable(Campaign(options_).Run({})));
}

TEST_F(CampaignTest, ARunThatIsInterruptedIsNotKept) {
  std::stop_source stop;
  options_.threads = 2;
  options_.scenarios = {"tiny", "kitchen"};
  options_.runs = 1;
  options_.strategies = {"closest"};
  const auto some = Campaign(options_).Run(stop.get_token(), [&](const Outcome&, std::size_t) {
    stop.request_stop();  // the kitchen would take seconds longer
  });
  ASSERT_EQ(some.size(), 1U);
  EXPECT_EQ(ToText(some.front().end), "complete");
  EXPECT_EQ(Campaign(options_).resumed(), 1U);
}

TEST_F(CampaignTest, PartsMergeToTheWhole) {
  const auto whole = Repeatable(Campaign(options_).Run({}));
  std::vector<std::filesystem::path> journals;
  std::size_t made = 0;
  for (const int shard : {0, 1}) {
    Campaign::Options part = options_;
    part.shard = {shard, 2};
    part.journal = folder_ / ("part" + std::to_string(shard));
    journals.push_back(part.journal);
    Campaign campaign(part);
    for (const Outcome& outcome : campaign.Run({})) {
      EXPECT_EQ(outcome.run % 2, shard);
      ++made;
    }
  }
  EXPECT_EQ(made, whole.size());

  options_.journal.clear();
  options_.merged = journals;
  const Campaign merged(options_);
  EXPECT_EQ(merged.resumed(), merged.total());
  EXPECT_EQ(Repeatable(merged.Outcomes()), whole);

  options_.merged.pop_back();
  EXPECT_EQ(Campaign(options_).resumed(), 4U);  // starts 0 and 2 of both strategies
  options_.merged = {folder_ / "none"};
  EXPECT_THROW(Campaign{options_}, std::runtime_error);
}

TEST_F(CampaignTest, AShardThatThereIsNotIsRefused) {
  for (const auto& [shard, shards] : {std::pair(2, 2), {-1, 2}, {0, 0}}) {
    options_.shard = {shard, shards};
    EXPECT_THROW(Campaign{options_}, std::invalid_argument);
  }
}

TEST_F(CampaignTest, RunsOfAnotherScenarioAreNotTakenOver) {
  Campaign(options_).Run({});
  options_.overrides = {"depth_sensor.disparity_noise_px=0.3"};
  EXPECT_EQ(Campaign(options_).resumed(), 0U);
}

TEST_F(CampaignTest, ATailIsRecordedOnlyWhenAskedForAndTheRunIsTheSame) {
  options_.runs = 1;
  options_.strategies = {"closest"};
  options_.overrides.clear();
  const Outcome plain = Campaign(options_).Run({}).at(0);
  EXPECT_FALSE(plain.tail);
  options_.tail = true;
  Campaign campaign(options_);
  EXPECT_EQ(campaign.resumed(), 0U) << "the journal's run has no tail";
  Outcome with = campaign.Run({}).at(0);
  ASSERT_TRUE(with.tail);
  EXPECT_NEAR(with.tail->begins.value(), PathTo(with, kTailCoverage).value(), 1e-9);
  EXPECT_NEAR(with.tail->begins.value() + with.tail->length(), with.distance, 1e-6);
  EXPECT_EQ(Campaign(options_).Outcomes().at(0).tail, with.tail) << "from the journal";
  with.tail.reset();
  EXPECT_EQ(Repeatable(with), Repeatable(plain));
  options_.tail = false;
  EXPECT_EQ(Campaign(options_).resumed(), 1U);
}

TEST_F(CampaignTest, SurfacesAreFusedOnlyWhenAskedForAndTheRunIsTheSame) {
  options_.runs = 1;
  options_.strategies = {"closest"};
  options_.overrides.clear();
  const Outcome plain = Campaign(options_).Run({}).at(0);
  EXPECT_FALSE(plain.surface);
  options_.meshes = folder_ / "meshes";
  Campaign campaign(options_);
  EXPECT_EQ(campaign.resumed(), 0U) << "the journal's run has no surface";
  Outcome with = campaign.Run({}).at(0);
  ASSERT_TRUE(with.surface);
  EXPECT_GT(with.surface->seen, 0.9);
  EXPECT_GT(std::filesystem::file_size(folder_ / "meshes" / "tiny-closest-1.ply"), 100000U);
  EXPECT_EQ(Campaign(options_).Outcomes().at(0).surface, with.surface) << "from the journal";
  EXPECT_EQ(Campaign(options_).resumed(), 1U);
  std::ofstream(folder_ / "meshes" / "tiny-closest-1.ply") << "of another run";
  EXPECT_EQ(Campaign(options_).resumed(), 0U) << "a run whose mesh was overwritten is made again";
  options_.meshes = folder_ / "elsewhere";
  EXPECT_EQ(Campaign(options_).resumed(), 0U) << "a run whose mesh is wanted and not there is made again";
  EXPECT_EQ(options_.merged.size(), 0U);
  options_.merged = {options_.journal};
  EXPECT_EQ(Campaign(options_).resumed(), 1U) << "a merge makes no runs";
  options_.merged = {};
  std::stop_source stopped;
  stopped.request_stop();
  const Outcome cut = Scene("tiny", {})
                          .Run("closest", 1, PoseSource::kTruth, stopped.get_token(), false,
                               MotionModel::kKinematic, options_.meshes);
  EXPECT_EQ(cut.end.kind, RunEnd::Kind::kInterrupted);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "elsewhere")) << "an interrupted run leaves no mesh";
  with.surface.reset();
  EXPECT_EQ(Repeatable(with), Repeatable(plain));
}

TEST_F(CampaignTest, SurfacesAreFusedAsTheScenarioSays) {
  options_.runs = 1;
  options_.strategies = {"closest"};
  options_.meshes = folder_ / "meshes";
  options_.overrides = {"surface.voxel_size_m=0.2", "surface.inspection_distance_m=0.5"};
  const SurfaceFigures coarse = Campaign(options_).Run({}).at(0).surface.value();
  options_.overrides = {};
  const SurfaceFigures usual = Campaign(options_).Run({}).at(0).surface.value();
  EXPECT_LT(coarse.f_near, 0.9 * usual.f_near);
  EXPECT_LT(coarse.inspected, 0.5 * usual.inspected);
  EXPECT_EQ(coarse.seen, usual.seen);
}

TEST_F(CampaignTest, AShardWithoutARunLeavesAJournalForTheMerge) {
  options_.runs = 1;
  options_.shard = {1, 2};
  EXPECT_TRUE(Campaign(options_).Run({}).empty());
  EXPECT_TRUE(std::filesystem::exists(options_.journal));
}

TEST_F(CampaignTest, MistakesAreRefusedBeforeAnyRun) {
  const auto error = [this] {
    try {
      const Campaign campaign(options_);
    } catch (const std::exception& caught) {
      return std::string(caught.what());
    }
    return std::string();
  };
  options_.strategies = {"closest", "wandering"};
  EXPECT_THAT(error(), HasSubstr("strategy is \"wandering\", must be one of closest, "));
  options_.strategies = {"closest", "cover", "closest"};
  EXPECT_EQ(error(), "strategy closest is given twice");
  options_.strategies = {"gaps"};
  EXPECT_THAT(error(), HasSubstr("scenario tiny: the strategy gaps is for a robot that drives"));
  options_.strategies = {"rift"};
  options_.overrides = {"robot.attitude=LEVEL"};
  EXPECT_THAT(error(), HasSubstr("look in any direction, and robot.attitude is LEVEL"));
  options_.overrides = {};
  options_.strategies = {"gaps"};
  options_.scenarios = {"warren"};
  EXPECT_EQ(error(), "");
  options_.strategies = {"closest"};
  options_.poses = {PoseSource::kTruth, PoseSource::kTruth};
  EXPECT_EQ(error(), "a source of poses is given twice");
  options_.poses = {PoseSource::kTruth};
  options_.scenarios = {"tiny", "tiny"};
  EXPECT_EQ(error(), "scenario tiny is given twice");
  options_.scenarios = {"nowhere"};
  EXPECT_THAT(error(), HasSubstr("nowhere"));
  options_.scenarios = {"tiny"};
  options_.overrides = {"world.scale=1000", "world.bounds_max_m={x: 3000 y: 2500 z: 1600}"};
  EXPECT_THAT(error(), HasSubstr("world.scale"));
  options_.overrides = {"simulator.start_position_m.x=0.05"};
  EXPECT_THAT(error(), HasSubstr("simulator.start_position_m"));
  options_.overrides.clear();
  options_.runs = 0;
  EXPECT_THAT(error(), HasSubstr("runs"));
}

TEST(OutcomeJson, IsReadBackToTheLastBitAndRefusedWhenItIsNone) {
  Outcome outcome = Scene("tiny").Run("closest", 4);
  outcome.end.ending.tight_ways = {{{1.5, 0.1, 0.3}, 0.25}};
  const auto json = nlohmann::json::parse(ToJson(outcome).dump());
  const Result<Outcome> back = OutcomeFromJson(json);
  ASSERT_TRUE(back);
  EXPECT_EQ(ToJson(*back).dump(), ToJson(outcome).dump());
  ASSERT_EQ(back->end.ending.tight_ways.size(), 1U);
  EXPECT_EQ(back->end.ending.tight_ways[0].area, 0.25);
  auto lacking = json;
  lacking.erase("coverage");
  ASSERT_FALSE(OutcomeFromJson(lacking));
  EXPECT_THAT(OutcomeFromJson(lacking).error(), HasSubstr("coverage"));
}

TEST(OutcomeJson, RowsCarryWhatTablesNeed) {
  const std::vector<Outcome> outcomes = {Scene("tiny").Run("closest", 1)};
  const auto rows = RowsOf(outcomes);
  ASSERT_EQ(rows.size(), 1U);
  for (const char* field : {"scenario", "strategy", "runs", "completed", "path_mean", "path_sd",
                            "path_p95_mean", "coverage_mean", "collisions", "plan_ms_p50", "plan_ms_p95"}) {
    EXPECT_TRUE(rows[0].contains(field)) << field;
  }
  EXPECT_EQ(rows[0]["path_mean"], outcomes[0].distance);
  EXPECT_TRUE(rows[0]["path_sd"].is_null()) << "one run has none";
}

TEST(OutcomeJson, OfAnEvaluationHasEverythingAboutItInOneObject) {
  const std::vector<Outcome> outcomes = {Scene("tiny").Run("closest", 1)};
  const auto json =
      EvaluationJson(outcomes, std::vector<std::string>{"mapper.fill=false", "robot.radius_m=0.1"});
  EXPECT_EQ(json["overrides"], (nlohmann::ordered_json{"mapper.fill=false", "robot.radius_m=0.1"}));
  EXPECT_EQ(json["rows"], RowsOf(outcomes));
  EXPECT_EQ(json["comparisons"], ComparisonsOf(outcomes));
  ASSERT_EQ(json["runs"].size(), 1U);
  EXPECT_EQ(json["runs"][0], ToJson(outcomes[0]));
  EXPECT_TRUE(EvaluationJson({}, {})["runs"].empty());
}

TEST(Shard, IsNumberedFromOne) {
  EXPECT_EQ(ShardFrom("1/1").index, 0);
  EXPECT_EQ(ShardFrom("3/4").index, 2);
  EXPECT_EQ(ShardFrom("3/4").count, 4);
  for (const char* text :
       {"", "1", "0/2", "3/2", "1/2 ", " 1/2", "1/ 2", "1/99999999999", "1/-2", "a/2", "1/2/3"})
    EXPECT_THROW(ShardFrom(text), std::invalid_argument) << text;
}

}  // namespace
}  // namespace thalweg::evaluator
