#include "services/surface/evaluation/framed_picture.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace thalweg::surface {
namespace {

bool HasInk(const cv::Mat& part) {
  cv::Mat gray;
  cv::cvtColor(part, gray, cv::COLOR_BGR2GRAY);
  double darkest = 255.0;
  cv::minMaxLoc(gray, &darkest);
  return darkest < 128.0;
}

TEST(FramedPicture, StandsUnchangedBetweenItsTitleAndItsLegend) {
  cv::Mat_<cv::Vec3b> picture(90, 400);
  for (int v = 0; v < picture.rows; ++v) {
    for (int u = 0; u < picture.cols; ++u)
      picture(v, u) = cv::Vec3b(static_cast<uchar>(u % 251), static_cast<uchar>(v), 200);
  }
  const cv::Mat framed = Framed(picture, "A title", {{{10, 200, 30}, "green"}, {{250, 20, 40}, "red"}});
  ASSERT_EQ(framed.cols, picture.cols);
  const cv::Vec3b green(30, 200, 10);
  const cv::Vec3b red(40, 20, 250);
  int top = -1;
  for (int v = 0; v + picture.rows <= framed.rows && top < 0; ++v) {
    if (cv::norm(framed.rowRange(v, v + picture.rows), picture, cv::NORM_INF) == 0.0) top = v;
  }
  ASSERT_GT(top, 0) << "the picture is not there pixel for pixel";
  EXPECT_TRUE(HasInk(framed.rowRange(0, top)));
  const cv::Mat below = framed.rowRange(top + picture.rows, framed.rows);
  EXPECT_TRUE(HasInk(below));
  for (const cv::Vec3b& color : {green, red}) {
    cv::Mat same;
    cv::inRange(below, color, color, same);
    EXPECT_GT(cv::countNonZero(same), 50) << color;
  }
}

}  // namespace
}  // namespace thalweg::surface
