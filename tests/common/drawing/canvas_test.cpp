#include "common/drawing/canvas.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace thalweg {
namespace {

const cv::Scalar kInk{0, 0, 0};
const cv::Scalar kGreen{0, 160, 0};

/// The bounding box of all that is not paper.
cv::Rect InkOn(const Canvas& canvas) {
  cv::Mat gray;
  cv::cvtColor(canvas.Picture(), gray, cv::COLOR_BGR2GRAY);
  return cv::boundingRect(gray < 250);
}

TEST(Canvas, AnImageKeepsItsPixels) {
  Canvas canvas(20, 10);
  cv::Mat_<cv::Vec3b> image(4, 6);
  for (int v = 0; v < 4; ++v) {
    for (int u = 0; u < 6; ++u)
      image(v, u) = cv::Vec3b(static_cast<uchar>(40 * u), static_cast<uchar>(50 * v), 7);
  }
  canvas.Image({10, 5, 6, 4}, image);
  EXPECT_EQ(cv::norm(canvas.Picture()(cv::Rect(10, 5, 6, 4)), image, cv::NORM_INF), 0.0);
}

TEST(Canvas, ShapesLieWhereTheyAreDrawn) {
  Canvas filled(40, 30);
  filled.Fill({5, 6, 10, 12}, kInk);
  EXPECT_NEAR(InkOn(filled).x, 5, 1);
  EXPECT_NEAR(InkOn(filled).br().y, 18, 1);
  Canvas disc(40, 30);
  disc.Disc({20, 15}, 6.0, kInk);
  EXPECT_NEAR(InkOn(disc).x, 14, 1);
  EXPECT_NEAR(InkOn(disc).width, 12, 2);
  Canvas line(40, 30);
  line.Line({5, 20}, {35, 20}, kInk, 1.0);
  EXPECT_NEAR(InkOn(line).width, 31, 2);
  EXPECT_LE(InkOn(line).height, 3);
}

TEST(Canvas, TextIsAlignedAsAskedFor) {
  const double width = Canvas::TextWidth("rift", 10.0);
  for (const auto& [align, left] :
       {std::pair(Align::kLeft, 100.0), std::pair(Align::kCenter, 100.0 - 0.5 * width),
        std::pair(Align::kRight, 100.0 - width)}) {
    Canvas canvas(200, 40);
    canvas.Text("rift", {100, 30}, 10.0, kInk, align);
    EXPECT_NEAR(InkOn(canvas).x, left, 2.5);
  }
}

TEST(Canvas, SwatchesStandSideBySide) {
  Canvas canvas(400, 30);
  const double next = canvas.Swatch({10, 15}, kGreen, "one");
  EXPECT_GT(next, 10.0 + Canvas::TextWidth("one", 10.0));
  EXPECT_LT(InkOn(canvas).br().x, next);
  cv::Mat green;
  cv::inRange(canvas.Picture(), kGreen, kGreen, green);
  EXPECT_NEAR(cv::boundingRect(green).y + 0.5 * cv::boundingRect(green).height, 15.0, 1.0);
  canvas.Swatch({next, 15}, kGreen, "two");
  cv::inRange(canvas.Picture(), kGreen, kGreen, green);
  EXPECT_GT(cv::boundingRect(green).br().x, next);
}

}  // namespace
}  // namespace thalweg
