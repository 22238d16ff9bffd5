#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "services/stereo/adapter/image_files.h"
#include "services/stereo/core/calibration.h"
#include "services/stereo/core/checks.h"
#include "services/stereo/core/opencv_view.h"
#include "tests/services/stereo/support/real_images.h"

namespace thalweg::stereo {
namespace {

namespace fs = std::filesystem;

using test::DataFolder;

/// [px] How far below its place in the left image each well-matched feature lies in the right one, by
/// normalized correlation of patches: a method that shares nothing with the code under test.
std::vector<double> RowErrors(const ByteImage& left, const ByteImage& right, int max_disparity) {
  constexpr int kPatch = 10;  // on either side
  constexpr int kRows = 3;    // searched above and below
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(ViewOf(left), corners, 400, 0.01, 8.0);
  std::vector<double> errors;
  for (const cv::Point2f& corner : corners) {
    const int u = static_cast<int>(corner.x);
    const int v = static_cast<int>(corner.y);
    const int first = std::max(0, u - max_disparity - kPatch);
    if (u < kPatch || v < kPatch + kRows || u + kPatch >= left.width() ||
        v + kPatch + kRows >= left.height()) {
      continue;
    }
    const cv::Mat patch = ViewOf(left)({u - kPatch, v - kPatch, 2 * kPatch + 1, 2 * kPatch + 1});
    const int height = 2 * (kPatch + kRows) + 1;
    const cv::Mat strip = ViewOf(right)({first, v - kPatch - kRows, u + kPatch - first + 1, height});
    cv::Mat_<float> score;
    cv::matchTemplate(strip, patch, score, cv::TM_CCOEFF_NORMED);
    double best = 0.0;
    cv::Point at;
    cv::minMaxLoc(score, nullptr, &best, nullptr, &at);
    if (best < 0.95 || at.y == 0 || at.y == score.rows - 1) continue;
    const float vertex = ParabolaVertex(-score(at.y - 1, at.x), -score(at.y, at.x), -score(at.y + 1, at.x));
    errors.push_back(at.y - kRows + static_cast<double>(vertex));
  }
  return errors;
}

double MedianSize(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  std::sort(values.begin(), values.end());
  return values.at(values.size() / 2);
}

TEST(Calibration, FeaturesOfEurocLieOnTheSameRowOnceRectified) {
  const auto folder = DataFolder("vo/euroc_v101_standstill");
  if (!folder) GTEST_SKIP() << "no vo/euroc_v101_standstill under THALWEG_DATA";
  // From the sensor files cam0.yaml and cam1.yaml of the data set.
  StereoCalibration c;
  c.left.width_px = c.right.width_px = 752;
  c.left.height_px = c.right.height_px = 480;
  c.left.K << 458.654, 0, 367.215, 0, 457.296, 248.375, 0, 0, 1;
  c.left.distortion = {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05};
  c.right.K << 457.587, 0, 379.999, 0, 456.134, 255.238, 0, 0, 1;
  c.right.distortion = {-0.28368365, 0.07451284, -0.00010473, -3.55590700e-05};
  Eigen::Matrix4d T_BL;
  T_BL << 0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975,  //
      0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768,          //
      -0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949,      //
      0, 0, 0, 1;
  Eigen::Matrix4d T_BR;
  T_BR << 0.0125552670891, -0.999755099723, 0.0182237714554, -0.0198435579556,  //
      0.999598781151, 0.0130119051815, 0.0251588363115, 0.0453689425024,        //
      -0.0253898008918, 0.0179005838253, 0.999517347078, 0.00786212447038,      //
      0, 0, 0, 1;
  c.T_RL = RigidTransform(T_BR).inverse() * RigidTransform(T_BL);
  const StereoRectifier rectifier(c);
  EXPECT_NEAR(rectifier.geometry().baseline, 0.11008, 1e-5);  // as stated in SOURCE.md of the data
  EXPECT_NEAR(rectifier.geometry().camera.fx, 436.235, 0.01);

  std::vector<double> errors;
  std::vector<double> raw_errors;
  for (const auto& entry : fs::directory_iterator(*folder / "cam0")) {
    const ByteImage left = ReadImage(entry.path());
    const ByteImage right = ReadImage(*folder / "cam1" / entry.path().filename());
    const auto some =
        RowErrors(Rectify(rectifier, Side::kLeft, left), Rectify(rectifier, Side::kRight, right), 80);
    errors.insert(errors.end(), some.begin(), some.end());
    const auto raw = RowErrors(left, right, 80);
    raw_errors.insert(raw_errors.end(), raw.begin(), raw.end());
  }
  ASSERT_GT(errors.size(), 1000U);
  std::printf("median distance of rows: %.3f px of %zu features (raw: %.3f px)\n", MedianSize(errors),
              errors.size(), MedianSize(raw_errors));
  EXPECT_LE(MedianSize(errors), 0.3);
}

TEST(Calibration, FeaturesOfTheChessboardPairsLieOnTheSameRowOnceRectified) {
  const fs::path folder = "/usr/share/doc/opencv-doc/examples/data";
  if (!fs::exists(folder / "left01.jpg")) GTEST_SKIP() << "package opencv-doc is not installed";
  const Board board{.columns = 9, .rows = 6, .square = 0.025};
  std::vector<BoardView> views;
  std::vector<std::pair<ByteImage, ByteImage>> pairs;
  for (int i = 1; i <= 14; ++i) {
    std::string end = std::to_string(100 + i).substr(1);
    end += ".jpg";
    if (!fs::exists(folder / ("left" + end)) || !fs::exists(folder / ("right" + end))) continue;
    pairs.emplace_back(ToGray(ReadImage(folder / ("left" + end))),
                       ToGray(ReadImage(folder / ("right" + end))));
    const auto left = FindBoard(pairs.back().first, board);
    const auto right = FindBoard(pairs.back().second, board);
    if (left && right) views.push_back({*left, *right});
  }
  ASSERT_GT(views.size(), 10U);
  const CalibrationResult result = Calibrate(views, board, 640, 480);
  EXPECT_LT(result.reprojection_px, 0.5);
  EXPECT_LE(result.epipolar_px, 0.3);
  const StereoRectifier rectifier(result.calibration);
  std::vector<double> errors;
  for (const auto& [left, right] : pairs) {
    const auto some =
        RowErrors(Rectify(rectifier, Side::kLeft, left), Rectify(rectifier, Side::kRight, right), 130);
    errors.insert(errors.end(), some.begin(), some.end());
  }
  ASSERT_GT(errors.size(), 500U);
  std::printf("median distance of rows: %.3f px of %zu features; corners %.3f px; reprojection %.3f px\n",
              MedianSize(errors), errors.size(), result.epipolar_px, result.reprojection_px);
  EXPECT_LE(MedianSize(errors), 0.3);
}

}  // namespace
}  // namespace thalweg::stereo
