#include "services/stereo/evaluation/benchmark.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "services/stereo/adapter/image_files.h"
#include "tests/support/random_images.h"

namespace thalweg::stereo {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// A data set with one plane of known disparity, and a pair that does not exist.
class BenchmarkTest : public testing::Test {
 protected:
  BenchmarkTest() {
    fs::create_directories(folder_ / "plane");
    const auto pair = test::PlanePair(120, 80, 0.0, 0.0, 6, 3);
    WriteImage(folder_ / "plane" / "left.png", pair.left);
    WriteImage(folder_ / "plane" / "right.png", pair.right);
    WriteImage(folder_ / "plane" / "gt.png", ByteImage(120, 80, 1, 48));
    std::ofstream(folder_ / "pairs.csv") << "name,scale,max_disparity\nplane,8,16\nnowhere,8,16\n";
  }
  ~BenchmarkTest() override { fs::remove_all(folder_); }

  const fs::path folder_ = fs::temp_directory_path() / ("benchmark_test_" + std::to_string(getpid()));
};

TEST_F(BenchmarkTest, JudgesEveryEngineAndGoesOnBehindABadPair) {
  std::vector<std::string> rows;
  BenchmarkListener listener;
  listener.row = [&](const BenchmarkRow& row) { rows.push_back(row.pair + ' ' + row.engine); };
  const Benchmark result = RunBenchmark({folder_, {"best", "opencv-bm"}, {}}, listener);
  EXPECT_THAT(rows, ElementsAre("plane best", "plane opencv-bm"));
  ASSERT_EQ(result.rows.size(), 2U);
  EXPECT_EQ(result.rows[0].evaluation.bad_non_occluded, 0.0);
  EXPECT_GT(result.rows[0].milliseconds, 0.0);
  EXPECT_EQ(result.pairs, 2U);
  EXPECT_EQ(result.failed, 1U);
  ASSERT_EQ(result.mistakes.size(), 1U);
  EXPECT_THAT(result.mistakes[0], HasSubstr("pairs.csv:3: nowhere: "));
}

TEST_F(BenchmarkTest, AnUnknownEngineIsRefusedBeforeAnyWork) {
  EXPECT_THROW(RunBenchmark({folder_, {"worst"}, {}}, {}), std::invalid_argument);
}

TEST(MeanRow, IsOverTheRowsOfOneEngineThatHaveAValue) {
  const std::vector<BenchmarkRow> rows = {{"a", "x", {0.1, kNone, 0.2, 1.0, 0.0}, 10.0},
                                          {"b", "x", {0.3, kNone, 0.4, 0.5, 0.0}, 20.0},
                                          {"b", "y", {0.9, 0.9, 0.9, 0.9, 0.9}, 99.0},
                                          {"c", "x", {kNone, kNone, 0.6, 0.0, 0.0}, 60.0}};
  const BenchmarkRow mean = MeanRow(rows, "x");
  EXPECT_EQ(mean.pair, "mean");
  EXPECT_EQ(mean.engine, "x");
  EXPECT_NEAR(mean.evaluation.bad_non_occluded, 0.2, 1e-12);
  EXPECT_TRUE(std::isnan(mean.evaluation.bad_near_discontinuities));
  EXPECT_NEAR(mean.evaluation.bad_all, 0.4, 1e-12);
  EXPECT_NEAR(mean.evaluation.density, 0.5, 1e-12);
  EXPECT_NEAR(mean.milliseconds, 30.0, 1e-12);
}

TEST(BenchmarkText, HasItsColumnsUnderTheHeading) {
  const std::string heading = BenchmarkHeading();
  const std::string row = ToText({"tsukuba", "best", {0.0123, kNone, 0.5, 1.0, 0.25}, 12.34});
  EXPECT_EQ(row.size(), heading.size());
  EXPECT_EQ(row,
            "tsukuba           best                 1.23        -    50.00   100.00    25.00     12.3\n");
}

TEST(BenchmarkJson, HasPercentagesAndNullWhereNothingCouldBeJudged) {
  Benchmark benchmark;
  benchmark.rows = {{"a", "x", {0.125, kNone, 0.25, 1.0, 0.0}, 10.0}};
  const nlohmann::json json = ToJson(benchmark);
  EXPECT_EQ(json["rows"][0]["bad_nonocc"], 12.5);
  EXPECT_TRUE(json["rows"][0]["bad_disc"].is_null());
  EXPECT_EQ(json["rows"][0]["ms"], 10.0);
  EXPECT_FALSE(json.contains("errors"));
  benchmark.mistakes = {"pairs.csv:2: b: why"};
  EXPECT_EQ(ToJson(benchmark)["errors"].size(), 1U);
}

}  // namespace
}  // namespace thalweg::stereo
