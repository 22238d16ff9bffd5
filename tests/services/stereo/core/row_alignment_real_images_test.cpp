#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "services/stereo/adapter/image_files.h"
#include "services/stereo/core/opencv_view.h"
#include "services/stereo/core/row_alignment.h"
#include "tests/services/stereo/support/real_images.h"

namespace thalweg::stereo {
namespace {

using test::DataFolder;
using test::kClassics;
using test::Scene;

TEST(RowAlignment, RowsOfMiddleburysPairsAgreeUntilOneImageIsMoved) {
  const auto folder = DataFolder("stereo");
  if (!folder) GTEST_SKIP() << "no stereo under THALWEG_DATA";
  for (const Scene& scene : kClassics) {
    const ByteImage left = ToGray(ReadImage(*folder / scene.name / "left.png"));
    const ByteImage right = ToGray(ReadImage(*folder / scene.name / "right.png"));
    const auto rows = MeasureRowAlignment(left, right, scene.max_disparity);
    ASSERT_TRUE(rows) << scene.name;
    EXPECT_LT(rows->CertainPx(), 0.3) << scene.name;
    ByteImage down(right.width(), right.height());
    cv::Mat moved = ViewOf(down);
    const cv::Mat by = (cv::Mat_<double>(2, 3) << 1, 0, 0, 0, 1, 0.8);
    cv::warpAffine(ViewOf(right), moved, by, moved.size(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
    const auto off = MeasureRowAlignment(left, down, scene.max_disparity);
    ASSERT_TRUE(off) << scene.name;
    EXPECT_NEAR(off->offset_px - rows->offset_px, 0.8, 0.1) << scene.name;
    EXPECT_GT(off->CertainPx(), kMostRowDifference) << scene.name;
  }
}

}  // namespace
}  // namespace thalweg::stereo
