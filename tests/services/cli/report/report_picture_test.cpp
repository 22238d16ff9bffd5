#include "services/cli/report/report_picture.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "tests/services/cli/report/example_run.h"

namespace thalweg::cli {
namespace {

using test::ARun;
using test::FillBox;
using test::FurnishedRoom;
using test::kVoxel;

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
  record.frontiers_left = 1;
  EXPECT_EQ(FrontiersInWords(record), "1 frontier (a place where the unknown begins) left to see");
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

}  // namespace
}  // namespace thalweg::cli
