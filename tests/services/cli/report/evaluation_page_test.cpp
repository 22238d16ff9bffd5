#include "services/cli/report/evaluation_page.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "common/voxel/for_each_voxel.h"

namespace thalweg::cli {
namespace {

using evaluator::Outcome;
using testing::HasSubstr;
using testing::Not;

/// A run whose coverage rises from 0 to `end` along a straight line over the distance, at 2 m/s.
Outcome Straight(const std::string& strategy, int run, double distance, double end = 1.0) {
  Outcome outcome;
  outcome.scenario = "room";
  outcome.strategy = strategy;
  outcome.run = run;
  outcome.seed = run + 1;
  outcome.distance = distance;
  outcome.duration = 2.0 * distance;
  outcome.coverage = end;
  for (int k = 0; k <= 1000; ++k) {
    const double share = k / 1000.0;
    outcome.progress.push_back({.time = 2.0 * distance * share,
                                .distance = distance * share,
                                .coverage = end * share,
                                .p_W = {distance * share, 1.0, 1.2}});
  }
  outcome.timings["plan"] = {.count = 10, .p50_ms = 5.0, .p95_ms = 20.0, .max_ms = 30.0};
  outcome.set_aside = {{explorer::AsideReason::kLookedAt, false, 2, 30}};
  return outcome;
}

TEST(CoverageCurve, IsTheMeanOfTheRunsWithTheMiddleHalfAround) {
  // Coverage at 5 m of runs of 10, 20, ..., 50 m: 0.5, 0.25, 1/6, 0.125, 0.1.
  std::vector<Outcome> outcomes;
  for (int n = 1; n <= 5; ++n) outcomes.push_back(Straight("a", n, 10.0 * n));
  std::vector<const Outcome*> runs;
  for (const Outcome& outcome : outcomes) runs.push_back(&outcome);
  const CoverageCurve curve = CurveOver(runs, &Outcome::Progress::distance);
  ASSERT_EQ(curve.at.size(), 201U);
  EXPECT_DOUBLE_EQ(curve.at.back(), 50.0);
  EXPECT_DOUBLE_EQ(curve.at[20], 5.0);
  constexpr double kStep = 0.0015;  // of the runs' own points
  EXPECT_NEAR(curve.mean[20], (0.5 + 0.25 + 1.0 / 6 + 0.125 + 0.1) / 5, kStep);
  EXPECT_NEAR(curve.low[20], 0.125, kStep);
  EXPECT_NEAR(curve.high[20], 0.25, kStep);
  EXPECT_DOUBLE_EQ(curve.mean.back(), 1.0) << "a run that has ended keeps its coverage";
  EXPECT_DOUBLE_EQ(CurveOver(runs, &Outcome::Progress::time).at.back(), 100.0);
}

TEST(WorldPicture, HasAPixelForEachColumnAndKnowsItsPlace) {
  OccupancyGrid grid(0.1);
  ForEachVoxel({{-10, 5, 0}, {20, 25, 1}}, [&](const VoxelIndex& i) { grid.Set(i, 1.0F); });
  ForEachVoxel({{-10, 5, 1}, {20, 25, 5}}, [&](const VoxelIndex& i) { grid.Set(i, -1.0F); });
  const WorldPicture picture = PictureOf(LookFromAbove(grid));
  EXPECT_DOUBLE_EQ(picture.min_x, -1.0);
  EXPECT_DOUBLE_EQ(picture.min_y, 0.5);
  EXPECT_DOUBLE_EQ(picture.width, 3.0);
  EXPECT_DOUBLE_EQ(picture.height, 2.0);
  EXPECT_LE(picture.lowest, picture.highest);
  const cv::Mat pixels = cv::imdecode(picture.png, cv::IMREAD_UNCHANGED);
  EXPECT_EQ(pixels.size(), cv::Size(30, 20));
  EXPECT_EQ(pixels.at<cv::Vec4b>(3, 3)[3], 255) << "known, so opaque";
}

TEST(EvaluationPage, SaysWhatTheColorsOfItsMapsMean) {
  const MapColors colors = ColorsOfMap();
  ASSERT_GE(colors.heights.size(), 2U);
  OccupancyGrid grid(0.1);
  ForEachVoxel({{0, 0, 0}, {10, 10, 5}}, [&](const VoxelIndex& i) { grid.Set(i, -1.0F); });
  ForEachVoxel({{0, 0, -1}, {10, 5, 0}}, [&](const VoxelIndex& i) { grid.Set(i, 1.0F); });
  const WorldPicture picture = PictureOf(LookFromAbove(grid));
  EXPECT_DOUBLE_EQ(picture.lowest, picture.highest);
  const cv::Mat pixels = cv::imdecode(picture.png, cv::IMREAD_UNCHANGED);
  const auto hex = [&](int row) {
    const cv::Vec4b& color = pixels.at<cv::Vec4b>(row, 5);
    return fmt::format("#{:02x}{:02x}{:02x}", color[2], color[1], color[0]);
  };
  EXPECT_EQ(hex(8), colors.heights.front()) << "the floor";
  EXPECT_EQ(hex(1), colors.hollow) << "no floor is known there";
  const nlohmann::ordered_json data = EvaluationData({}, {});
  EXPECT_EQ(data["colors"]["heights"].size(), colors.heights.size());
  EXPECT_EQ(data["colors"]["wall"], colors.wall);
}

TEST(EvaluationPage, HoldsEachStartOfEachStrategy) {
  const std::vector<Outcome> outcomes = {Straight("closest", 0, 40.0), Straight("closest", 1, 42.0),
                                         Straight("flow", 0, 30.0, 0.9), Straight("flow", 1, 31.0)};
  const nlohmann::ordered_json data = EvaluationData(outcomes, {});
  const auto& strategies = data["scenarios"][0]["strategies"];
  ASSERT_EQ(strategies.size(), 2U);
  EXPECT_EQ(strategies[0]["runs"].size(), 2U);
  EXPECT_EQ(strategies[1]["runs"][0]["distance_m"], 30.0);
  EXPECT_TRUE(strategies[1]["runs"][0]["to_95_m"].is_null()) << "it never got there";
  EXPECT_NEAR(strategies[0]["runs"][0]["to_95_m"].get<double>(), 38.0, 0.1);
  EXPECT_TRUE(data["scenarios"][0]["world"].is_null());
}

TEST(EvaluationPage, SaysItsVerdictFirstAndItsDefinitionsLastAndLeavesNothingUnescaped) {
  std::vector<Outcome> outcomes;
  for (int run = 0; run < 7; ++run) outcomes.push_back(Straight("closest", run, 40.0 + run));
  for (int run = 0; run < 7; ++run) outcomes.push_back(Straight("</script><b>", run, 30.0 + run));
  outcomes.back().end.kind = evaluator::RunEnd::Kind::kCutOff;
  const std::string html = EvaluationHtml(outcomes, {}, std::vector<std::string>{"explorer.x=<b>"});
  for (const char* text : {"cut off", "looked at and stayed unknown", "&lt;/script&gt;&lt;b&gt;",
                           "1 of 14 runs did not complete", "All runs with explorer.x=&lt;b&gt;."}) {
    EXPECT_THAT(html, HasSubstr(text));
  }
  EXPECT_THAT(html, Not(HasSubstr("</script><b>")));
  EXPECT_THAT(html, Not(HasSubstr("src=\"")));
  EXPECT_THAT(html, Not(HasSubstr("href=\"http")));
  EXPECT_THAT(html, Not(HasSubstr("url(")));
  EXPECT_LT(html.find("shorter to 95 % coverage than closest"), html.find("<table>"));
  EXPECT_GT(html.find("What the words mean"), html.rfind("</table>"));
  for (const char* word : {"path, sd", "coverage, least", "collisions, nearest", "plan:", "ratio:"}) {
    EXPECT_GT(html.find(word), html.find("What the words mean")) << word;
    EXPECT_NE(html.find(word), std::string::npos) << word;
  }
}

}  // namespace
}  // namespace thalweg::cli
