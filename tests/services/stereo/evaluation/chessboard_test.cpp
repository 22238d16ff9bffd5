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

}  // namespace
}  // namespace thalweg::stereo
