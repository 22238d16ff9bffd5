#include "services/stereo/evaluation/chessboard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <limits>

namespace thalweg::stereo {
namespace {

namespace fs = std::filesystem;

TEST(Board, IsReadAsItIsWritten) {
  const Board board = BoardFrom("7x5", 0.025);
  EXPECT_EQ(board.columns, 7);
  EXPECT_EQ(board.rows, 5);
  EXPECT_EQ(board.square, 0.025);
  EXPECT_EQ(ToText(board), "7x5");
}

TEST(Board, IsRefusedWhenItIsNone) {
  for (const char* const text : {"9x6x", "9", "x6", "9x", "2x6", "9x999", "9.5x6", "-9x6", ""}) {
    EXPECT_THROW(BoardFrom(text, 0.025), std::runtime_error) << text;
  }
  for (const double square : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(BoardFrom("9x6", square), std::runtime_error) << square;
  }
}

TEST(PicturePairs, AreThoseOfWhichBothHalvesAreThere) {
  const fs::path folder = fs::temp_directory_path() / ("picture_pairs_" + std::to_string(getpid()));
  fs::create_directories(folder);
  for (const char* const name :
       {"left02.png", "right02.png", "left01.png", "right01.png", "left03.png", "right03.jpg", "other.png"}) {
    std::ofstream(folder / name) << "x";
  }
  const std::vector<PicturePair> pairs = PicturePairsIn(folder);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0].left, folder / "left01.png");
  EXPECT_EQ(pairs[0].right, folder / "right01.png");
  EXPECT_EQ(pairs[1].right, folder / "right02.png");
  fs::remove_all(folder);
  EXPECT_THROW(PicturePairsIn(folder), std::runtime_error);
}

TEST(Describe, ReportsPairsErrorsAndBaseline) {
  PictureCalibration calibration;
  calibration.pairs = 12;
  calibration.views = 10;
  calibration.result.reprojection_px = 0.1234;
  calibration.result.epipolar_px = 0.25;
  calibration.result.epipolar_worst_px = 1.5;
  calibration.rectified.baseline = 0.12;
  EXPECT_EQ(
      Describe(calibration),
      "10 of 12 pairs; reprojection error 0.123 px (root mean square), epipolar error 0.250 px (median), "
      "1.500 px (worst); baseline 0.120 m");
}

/// Photographs of a board that come with OpenCV's documentation, and a calibration from every second of them.
class PhotographedBoard : public testing::Test {
 protected:
  void SetUp() override {
    const fs::path folder = "/usr/share/doc/opencv-doc/examples/data";
    if (!fs::exists(folder / "left01.jpg")) GTEST_SKIP() << "package opencv-doc is not installed";
    std::vector<PicturePair> from;
    bool is_other = false;
    for (const PicturePair& pair : PicturePairsIn(folder)) {
      const std::string name = pair.left.filename().string();
      if (name.size() != std::string("left01.jpg").size()) continue;
      (is_other ? others_ : from).push_back(pair);
      is_other = !is_other;
    }
    calibration_ = CalibrateFromPictures(from, board_, [](const PicturePair&) {}).result.calibration;
  }

  /// The same after the right camera has turned in its mount [rad].
  StereoCalibration Turned(double angle, const Eigen::Vector3d& axis_R) const {
    StereoCalibration turned = calibration_;
    turned.T_RL = RigidTransform(Eigen::AngleAxisd(angle, axis_R)) * calibration_.T_RL;
    return turned;
  }

  const Board board_{.columns = 9, .rows = 6, .square = 0.025};
  StereoCalibration calibration_;
  std::vector<PicturePair> others_;
};

constexpr double kTurn = 0.004;  // [rad] 2 px

TEST_F(PhotographedBoard, ACalibrationFitsPicturesThatItWasNotMadeFrom) {
  const CalibrationCheck check = CheckCalibration(calibration_, others_, board_, 192);
  EXPECT_EQ(check.pairs, others_.size());
  EXPECT_GE(check.views, 5U);
  ASSERT_TRUE(check.rows);
  EXPECT_LT(check.rows->CertainPx(), 0.3);
  EXPECT_NEAR(check.scale, 1.0, 0.01);
  EXPECT_TRUE(check.good());
  EXPECT_THAT(Describe(check), testing::EndsWith("\nthe calibration is right"));
}

TEST_F(PhotographedBoard, ATiltedCameraShowsInTheRows) {
  const CalibrationCheck check =
      CheckCalibration(Turned(kTurn, Eigen::Vector3d::UnitX()), others_, std::nullopt, 192);
  ASSERT_TRUE(check.rows);
  EXPECT_NEAR(std::abs(check.rows->offset_px), kTurn * calibration_.right.K(0, 0), 0.5);
  EXPECT_FALSE(check.good());
  EXPECT_THAT(Describe(check), testing::HasSubstr("differ by up to"));
  EXPECT_THAT(Describe(check), testing::EndsWith("\ncalibrate again"));
}

TEST_F(PhotographedBoard, APannedCameraShowsOnlyInLengths) {
  const StereoCalibration panned = Turned(kTurn, Eigen::Vector3d::UnitY());
  EXPECT_TRUE(CheckCalibration(panned, others_, std::nullopt, 192).good());
  const CalibrationCheck check = CheckCalibration(panned, others_, board_, 192);
  EXPECT_FALSE(check.good());
  EXPECT_NEAR(std::abs(check.disparity_off_px), kTurn * calibration_.right.K(0, 0), 0.5);
}

TEST_F(PhotographedBoard, PicturesOfAnotherSizeAreNamed) {
  StereoCalibration other = calibration_;
  other.left.width_px = other.right.width_px = 800;
  EXPECT_THROW(CheckCalibration(other, others_, board_, 192), std::runtime_error);
}

TEST(CalibrationCheck, SaysWhatWasMeasured) {
  CalibrationCheck check{.pairs = 7, .views = 5, .scale = 1.02, .disparity_off_px = 1.4};
  EXPECT_EQ(Describe(check),
            "7 pairs: too few corners are in both images to compare rows\n"
            "5 views of the board: its squares measure +2.00 %, as if disparities were off by -1.40 px\n"
            "calibrate again");
  check.views = 0;
  check.scale = 1.0;
  EXPECT_EQ(Describe(check), "7 pairs: too few corners are in both images to compare rows");
}

}  // namespace
}  // namespace thalweg::stereo
