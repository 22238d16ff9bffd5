#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "common/voxel/for_each_voxel.h"
#include "services/cli/report/chart.h"
#include "services/cli/report/coverage_tally.h"
#include "services/cli/report/live_line.h"
#include "services/cli/report/map_picture.h"
#include "services/cli/report/report_json.h"
#include "services/cli/report/report_picture.h"
#include "services/cli/report/trajectory_picture.h"

namespace thalweg::cli {
namespace {

constexpr double kVoxel = 0.1;

void FillBox(OccupancyGrid& grid, const VoxelBox& box, float log_odds) {
  ForEachVoxel(box, [&](const VoxelIndex& i) { grid.Set(i, log_odds); });
}

/// A room of 6 x 4 x 2 m inside, with walls, floor and ceiling, a table top at 0.7 m and a cupboard.
OccupancyGrid FurnishedRoom() {
  OccupancyGrid grid(kVoxel);
  FillBox(grid, {{-1, -1, -1}, {61, 41, 21}}, 2.0F);
  FillBox(grid, {{0, 0, 0}, {60, 40, 20}}, -2.0F);
  FillBox(grid, {{20, 10, 6}, {32, 18, 7}}, 2.0F);
  FillBox(grid, {{50, 0, 0}, {60, 6, 18}}, 2.0F);
  FillBox(grid, {{29, 20, 0}, {31, 40, 20}}, 2.0F);
  return grid;
}

RunRecord ARun() {
  RunRecord record;
  record.title = "A furnished room";
  record.scenario = "room";
  record.strategy = "potential";
  record.stop_reason = "complete";
  record.stop_details = "1 m2 of frontier stayed unknown";
  record.distance = 31.25;
  record.duration = 120.0;
  record.wall = 30.0;
  record.free_volume = 44.0;
  record.occupied_volume = 4.0;
  record.true_collisions = 0;
  record.least_clearance = 0.041;
  record.agreement = 0.98123;
  record.coverage = 0.99;
  record.plans = 23;
  record.set_aside = {{"looked at twice and stayed", 3, 41}};
  record.planning = {{"field", 23, 31.0, 60.5, 71.25}};
  record.integration = {{"integration", 600, 2.0, 3.5, 9.0}};
  record.rejected = {{"mapper", "depth/points rejected", 2, "NaN"}, {"explorer", "odometry rejected", 1, ""}};
  for (int i = 0; i <= 240; ++i) {
    const double t = 0.5 * i;
    const double angle = 2.0 * std::numbers::pi * t / 120.0;
    const Eigen::Vector3d p(3.0 + 2.2 * std::cos(angle) + 0.3 * std::cos(5 * angle),
                            1.2 + 0.8 * std::sin(angle), 1.2);
    record.trajectory.push_back({Time{} + FromSeconds(t), MakeTransform(RotationFromYawPitch(angle, 0), p)});
    ProgressSample sample;
    sample.time = t;
    sample.distance = 31.25 * t / 120.0;
    sample.explored = 48.0 * (1.0 - std::exp(-t / 30.0));
    sample.coverage = 0.99 * (1.0 - std::exp(-t / 25.0));
    record.progress.push_back(sample);
  }
  return record;
}

ProgressSample At(double time, double distance) {
  ProgressSample sample;
  sample.time = time;
  sample.distance = distance;
  return sample;
}

TEST(ReportJson, HasEveryKeyAndItsValue) {
  const auto json = ToJson(ARun());
  for (const char* key : {"scenario",        "strategy",
                          "stop_reason",     "stop_details",
                          "distance_m",      "duration_s",
                          "wall_s",          "explored_m3",
                          "free_m3",         "occupied_m3",
                          "true_collisions", "least_clearance_m",
                          "agreement",       "coverage",
                          "coverage_over",   "frontiers_set_aside",
                          "frontiers_left",  "plans",
                          "replans",         "planning",
                          "integration",     "messages_rejected",
                          "messages_dropped"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json["explored_m3"], 48.0);
  EXPECT_EQ(json["messages_rejected"]["total"], 3);
  EXPECT_EQ(json["messages_dropped"]["total"], 0);
  EXPECT_EQ(json["frontiers_set_aside"][0]["voxels"], 41);
  EXPECT_EQ(json["planning"][0]["p95_ms"], 60.5);
  EXPECT_EQ(json["stop_details"], "1 m2 of frontier stayed unknown");
  EXPECT_EQ(json["coverage_over"].size(), 241U);
  EXPECT_EQ(nlohmann::json::parse(json.dump())["stop_reason"], "complete");
}

TEST(ReportJson, WhatIsNotKnownIsNull) {
  RunRecord record = ARun();
  record.true_collisions.reset();
  record.agreement.reset();
  record.least_clearance = std::nan("");
  record.progress.front().coverage.reset();
  const auto json = ToJson(record);
  EXPECT_TRUE(json["true_collisions"].is_null());
  EXPECT_TRUE(json["agreement"].is_null());
  EXPECT_TRUE(json["least_clearance_m"].is_null());
  EXPECT_TRUE(json["coverage_over"][0]["coverage"].is_null());
}

TEST(CoverageTally, CountsEachVoxelOnceAndDecidesLaterWhichOnesMatter) {
  CoverageTally tally;
  for (int x = 0; x < 4; ++x) tally.Add(VoxelIndex{x, -1, 9});
  tally.Add(VoxelIndex{0, -1, 9});
  tally.Sample(At(1.0, 0.5), 0.001);
  for (int x = 0; x < 10; ++x) tally.Add(VoxelIndex{x, -1, 9});
  tally.Sample(At(2.0, 1.0), 0.001);
  const auto samples = tally.SamplesWith([](const VoxelIndex& i) { return i.x % 2 == 0; }, 8);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_DOUBLE_EQ(samples[0].explored, 0.004);
  EXPECT_DOUBLE_EQ(samples[1].explored, 0.010);
  EXPECT_DOUBLE_EQ(*samples[0].coverage, 2.0 / 8.0);
  EXPECT_DOUBLE_EQ(*samples[1].coverage, 5.0 / 8.0);
  EXPECT_FALSE(tally.samples()[0].coverage);
}

TEST(CoverageTally, HoldsNoMoreThanItsLimitsAndSaysSo) {
  CoverageTally voxels(/*most_voxels=*/10);
  for (int x = 0; x < 10; ++x) voxels.Add(VoxelIndex{x, 0, 0});
  EXPECT_FALSE(voxels.full());
  voxels.Add(VoxelIndex{3, 0, 0});  // counted already
  EXPECT_FALSE(voxels.full());
  voxels.Add(VoxelIndex{10, 0, 0});
  EXPECT_TRUE(voxels.full());
  EXPECT_EQ(voxels.known(), 10U);
  CoverageTally blocks(CoverageTally::kMostVoxels, /*most_blocks=*/5);
  for (int x = 0; x < 100; ++x) blocks.Add(VoxelIndex{100 * x, 0, 0});
  EXPECT_TRUE(blocks.full());
  EXPECT_EQ(blocks.known(), 5U);
}

TEST(NiceTicks, AreRoundAndWithinTheAxis) {
  EXPECT_EQ(NiceTicks(0.0, 100.0, 5), (std::vector<double>{0, 20, 40, 60, 80, 100}));
  EXPECT_EQ(NiceTicks(0.0, 0.9, 4).size(), 2U);
  EXPECT_EQ(NiceTicks(0.0, 23.0, 6), (std::vector<double>{0, 5, 10, 15, 20}));
  EXPECT_EQ(TickText(0.25, 0.05), "0.25");
  EXPECT_EQ(TickText(20.0, 20.0), "20");
}

TEST(LiveLine, ReportsWhatMattersAndFitsTheTerminal) {
  LiveState state{.time = 83.0,
                  .rate = 4.9,
                  .explored = 61.25,
                  .coverage = 0.5,
                  .frontiers = 12,
                  .distance = 20.5,
                  .collisions = 0,
                  .unheard = {},
                  .stop = "",
                  .trouble = "",
                  .activity = "moving to a frontier",
                  .left = std::nullopt};
  const std::string line = LiveLine(state, 200);
  for (const char* part : {"1:23", "4.9x", "61.2 m3", "50.0 %", " 12 ", "20.5 m", "moving to"}) {
    EXPECT_NE(line.find(part), std::string::npos) << part << " in " << line;
  }
  EXPECT_EQ(line.find("COLLISION"), std::string::npos);
  state.collisions = 2;
  EXPECT_NE(LiveLine(state, 200).find("2 COLLISIONS"), std::string::npos);
  EXPECT_EQ(LiveLine(state, 200).find("silent"), std::string::npos);
  state.silence = 12.0;
  EXPECT_NE(LiveLine(state, 200).find("explorer silent for 12 s: moving"), std::string::npos);
  state.stop = "path silent";
  EXPECT_NE(LiveLine(state, 200).find("robot stopped: path silent; explorer silent for 12 s: moving"),
            std::string::npos);
  EXPECT_EQ(ClockText(3723.0), "1:02:03");
}

TEST(LiveLine, ALineThatIsTooLongEndsWithAWholeWord) {
  LiveState state;
  state.activity = "moving to a frontier, 3.0 m left";
  const std::string whole = LiveLine(state, 99);
  EXPECT_TRUE(whole.ends_with(state.activity));
  EXPECT_EQ(LiveLine(state, whole.size()), whole);
  const std::string ellipsis = "\u2026";
  for (std::size_t columns = whole.size() - state.activity.size(); columns < whole.size(); ++columns) {
    std::string line = LiveLine(state, columns);
    ASSERT_TRUE(line.ends_with(ellipsis)) << line;
    line.resize(line.size() - ellipsis.size());
    EXPECT_LT(line.size(), columns);
    EXPECT_TRUE(whole.starts_with(line)) << line;
    const char next = whole[line.size()];
    EXPECT_TRUE(next == ' ' || next == ',') << line;
  }
}

TEST(LiveLine, ColumnsStandUnderTheirHeading) {
  const LiveState full{.time = 3723.0,
                       .rate = 14.9,
                       .explored = 1061.25,
                       .coverage = 1.0,
                       .frontiers = 1234,
                       .distance = 1020.5,
                       .collisions = 0,
                       .unheard = {},
                       .stop = "",
                       .trouble = "",
                       .activity = "activity",
                       .left = std::nullopt};
  LiveState empty;
  empty.activity = full.activity;
  for (const std::size_t columns : {80U, 200U}) {
    const std::string heading = LiveHeading(columns);
    for (const LiveState& state : {full, empty}) {
      const std::string line = LiveLine(state, columns);
      EXPECT_EQ(line.find("activity"), heading.find("activity")) << line;
      for (const char* column :
           {"time", "speed", "explored", "known", columns < 100 ? "left" : "frontiers", "path"}) {
        const std::size_t end = heading.find(column) + std::string(column).size();
        EXPECT_NE(line[end - 1], ' ') << column << " in " << line;
        EXPECT_EQ(line[end], ' ') << column << " in " << line;
      }
    }
  }
}

TEST(LiveLine, SaysWhatIsMissing) {
  LiveState state;
  state.unheard = {"pose", "controller"};
  EXPECT_TRUE(LiveLine(state, 200).ends_with("  no pose, controller yet"));
  state.unheard = {"controller"};
  state.activity = "going 3.0 m";
  EXPECT_TRUE(LiveLine(state, 200).ends_with("  no controller: going 3.0 m"));
  EXPECT_NE(LiveLine(state, 79).find("  no controller: going 3.0 m"), std::string::npos) << "80 columns";
}

TEST(MapFromAbove, ShowsTableTopsFloorsAndWallsButNoCeiling) {
  const MapFromAbove map = LookFromAbove(FurnishedRoom());
  ASSERT_EQ(map.kind.cols, 62);
  ASSERT_EQ(map.kind.rows, 42);
  const auto row_of = [&](int y) { return map.kind.rows - 1 - (y - map.min_y); };
  const auto kind_at = [&](int x, int y) {
    return static_cast<ColumnKind>(map.kind(row_of(y), x - map.min_x));
  };
  EXPECT_EQ(kind_at(5, 5), ColumnKind::kSurface);
  EXPECT_FLOAT_EQ(map.height(row_of(5), 5 - map.min_x), 0.0F);
  EXPECT_FLOAT_EQ(map.height(row_of(12), 25 - map.min_x), 0.7F);
  EXPECT_FLOAT_EQ(map.height(row_of(2), 55 - map.min_x), 1.8F);
  EXPECT_EQ(kind_at(-1, 10), ColumnKind::kWall);
  EXPECT_EQ(kind_at(30, 30), ColumnKind::kWall);
}

TEST(MapFromAbove, StrayVoxelsFarAwayChangeNothingButAreCounted) {
  OccupancyGrid grid = FurnishedRoom();
  const MapFromAbove without = LookFromAbove(grid);
  EXPECT_EQ(LeftOutText(without), "");
  grid.Set({4095 * 8, 4095 * 8, 0}, 2.0F);
  grid.Set({-4095 * 8, -4095 * 8, 0}, 2.0F);
  const MapFromAbove with = LookFromAbove(grid);
  EXPECT_EQ(with.columns, 62U * 42U + 2U);
  EXPECT_EQ(with.columns_left_out, 2U);
  EXPECT_EQ(with.min_x, without.min_x);
  EXPECT_EQ(with.min_y, without.min_y);
  ASSERT_EQ(with.kind.size(), without.kind.size());
  EXPECT_EQ(cv::norm(with.kind, without.kind, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(with.height, without.height, cv::NORM_INF), 0.0);
  EXPECT_EQ(LeftOutText(with), "2 of 2606 known columns are not drawn: they lie up to 3275 m outside");
  Canvas said(1060, 900);
  Canvas silent(1060, 900);
  DrawMap(said, {0, 0, 1060, 900}, with, {});
  DrawMap(silent, {0, 0, 1060, 900}, without, {});
  EXPECT_GT(cv::norm(said.Picture(), silent.Picture(), cv::NORM_INF), 0.0);
}

TEST(MapFromAbove, ShowsThePartWithThePathEvenIfAnotherOneIsLarger) {
  OccupancyGrid grid(kVoxel);
  FillBox(grid, {{0, 0, 0}, {20, 20, 1}}, 2.0F);
  FillBox(grid, {{30'000, 0, 0}, {30'100, 100, 1}}, 2.0F);
  EXPECT_EQ(LookFromAbove(grid).min_x, 30'000);
  const TimedPose pose{Time{}, MakeTransform(Eigen::Matrix3d::Identity(), {1.0, 1.0, 0.5})};
  const MapFromAbove map = LookFromAbove(grid, {pose});
  EXPECT_EQ(map.min_x, 0);
  EXPECT_EQ(map.kind.cols, 20);
  EXPECT_EQ(map.columns_left_out, 10'000U);
}

TEST(MapFromAbove, PartsThatTogetherStaySmallEnoughAreAllDrawn) {
  OccupancyGrid grid(kVoxel);
  grid.Set({0, 0, 0}, 2.0F);
  grid.Set({900, 900, 0}, 2.0F);
  const MapFromAbove map = LookFromAbove(grid);
  EXPECT_EQ(map.kind.cols, 901);
  EXPECT_EQ(map.columns_left_out, 0U);
  EXPECT_EQ(map.voxels_per_pixel, 1);
}

TEST(MapFromAbove, AVastConnectedMapIsDrawnWithSeveralColumnsAsOnePixel) {
  OccupancyGrid grid(kVoxel);
  for (int k = -32'760; k < 32'760; k += 8) {  // a diagonal through everything that can be indexed
    grid.Set({k, k, 5}, 2.0F);
    grid.Set({k, k, 9}, -2.0F);
  }
  const MapFromAbove map = LookFromAbove(grid);
  EXPECT_LE(map.kind.total(), std::size_t{kMostEdge} * kMostEdge);
  EXPECT_EQ(map.columns_left_out, 0U);
  EXPECT_EQ(map.voxels_per_pixel, 33);  // 65513 columns / 33 = 1986 pixels, of which 4 million have room
  for (int k = 0; k < map.kind.cols; ++k) {
    EXPECT_EQ(map.kind(map.kind.rows - 1 - k, k), static_cast<std::uint8_t>(ColumnKind::kSurface));
    EXPECT_FLOAT_EQ(map.height(map.kind.rows - 1 - k, k), 0.6F);
  }
}

TEST(MapFromAbove, EmptyMapIsEmpty) {
  EXPECT_TRUE(LookFromAbove(OccupancyGrid(kVoxel)).kind.empty());
}

TEST(ReportPicture, ShowsThePathOverTheFloorAndTheCurves) {
  const OccupancyGrid map = FurnishedRoom();
  const cv::Mat picture = DrawReport(ARun(), &map);
  EXPECT_GE(picture.cols, 1200);
  EXPECT_EQ(picture.type(), CV_8UC3);
  if (const char* folder = std::getenv("THALWEG_PICTURES")) {
    ASSERT_TRUE(cv::imwrite(std::string(folder) + "/report.png", picture));
  }
}

TEST(ReportPicture, IsTheSameHoweverLongTheRobotStoodAfterTheEnd) {
  const OccupancyGrid map = FurnishedRoom();
  RunRecord record = ARun();
  const cv::Mat before = DrawReport(record, &map);
  TimedPose later = record.trajectory.back();
  later.stamp += FromSeconds(7.0);
  record.trajectory.push_back(later);
  EXPECT_EQ(cv::norm(before, DrawReport(record, &map), cv::NORM_INF), 0.0);
  record.duration += 7.0;
  EXPECT_GT(cv::norm(before, DrawReport(record, &map), cv::NORM_INF), 0.0);
}

TEST(ReportPicture, CountsTheFrontiersInWords) {
  RunRecord record;
  EXPECT_EQ(FrontiersInWords(record), "0 frontiers (places where the unknown begins) left to see");
  record.frontiers_left = 2;
  record.set_aside = {{"visited without progress", 11, 90}, {"too small to matter", 39, 80}};
  EXPECT_EQ(
      FrontiersInWords(record),
      "2 frontiers (places where the unknown begins) left to see; set aside: 11 visited without progress, "
      "39 too small to matter");
}

TEST(ReportPicture, HasEachColorOfItsLegend) {
  const auto count = [](const cv::Mat& picture, const cv::Scalar& color) {
    cv::Mat same;
    cv::inRange(picture, color, color, same);
    return cv::countNonZero(same);
  };
  const cv::Scalar below_unseen(236, 206, 226);
  OccupancyGrid map = FurnishedRoom();
  const int legend = count(DrawReport(ARun(), &map), below_unseen);
  EXPECT_GT(legend, 50);
  FillBox(map, {{5, 25, -1}, {15, 35, 0}}, OccupancyGrid::kUnknown);
  EXPECT_GT(count(DrawReport(ARun(), &map), below_unseen), 10 * legend);
}

TEST(ReportPicture, IsDrawnWithoutMapPathOrTruth) {
  RunRecord record;
  record.scenario = "robot";
  record.stop_reason = "interrupted";
  EXPECT_FALSE(DrawReport(record, nullptr).empty());
  record.trajectory.push_back({Time{}, RigidTransform::Identity()});
  record.progress.push_back({});
  OccupancyGrid one(kVoxel);
  one.Set({0, 0, 0}, -1.0F);
  EXPECT_FALSE(DrawReport(record, &one).empty());
}

/// Number of pixels of a picture with approximately the given color.
int PixelsOf(const cv::Mat& picture, const cv::Scalar& color) {
  cv::Mat hits;
  cv::inRange(picture, color - cv::Scalar::all(12), color + cv::Scalar::all(12), hits);
  return cv::countNonZero(hits);
}

TEST(MapPicture, AKeyOfOneHeightShowsOneColorAndNoGradient) {
  const auto deepest_blue = [](const OccupancyGrid& grid) {
    Canvas canvas(1060, 900);
    DrawMap(canvas, {0, 0, 1060, 900}, LookFromAbove(grid), {});
    return PixelsOf(canvas.Picture(), cv::Scalar(104, 96, 44));  // the color of the highest surface
  };
  OccupancyGrid floor(kVoxel);
  FillBox(floor, {{0, 0, -1}, {40, 30, 0}}, 2.0F);
  FillBox(floor, {{0, 0, 0}, {40, 30, 8}}, -2.0F);
  EXPECT_EQ(deepest_blue(floor), 0);
  EXPECT_GT(deepest_blue(FurnishedRoom()), 0);
}

TEST(TrajectoryPicture, ShowsThePathOverTheTrueOne) {
  TrajectoryPicture picture{"a path", {"with text"}, {}, {}};
  for (int i = 0; i <= 50; ++i) {
    picture.path.emplace_back(0.2 * i, 0.02 * i, 0.1);
    picture.true_path.emplace_back(0.2 * i, 0.0, 0.0);
  }
  const cv::Mat both = Draw(picture);
  const cv::Scalar truth(92, 138, 46);
  const cv::Scalar path(148, 98, 24);
  EXPECT_GT(PixelsOf(both, path), 500);
  EXPECT_GT(PixelsOf(both, truth), 1000);
  picture.true_path.clear();
  EXPECT_EQ(PixelsOf(Draw(picture), truth), 0);
}

TEST(TrajectoryPicture, IsDrawnForACameraThatStandsAndForNone) {
  TrajectoryPicture picture{"standing", {}, {Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(1, 2, 3)}, {}};
  EXPECT_FALSE(Draw(picture).empty());
  picture.path.clear();
  EXPECT_FALSE(Draw(picture).empty());
}

}  // namespace
}  // namespace thalweg::cli
