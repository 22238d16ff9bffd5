#include "common/camera/stereo_bias.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace thalweg {
namespace {

const PinholeCamera kCamera = PinholeCamera::FromFieldOfView(512, 384, 1.2);

/// Evidence of this much, of which the motion hides a part: 0 = nothing, 1 = all of it.
void Add(StereoBiasMonitor& monitor, const DisparityBias& measured, double hidden = 0.5) {
  const Eigen::Matrix2d information =
      Eigen::Vector2d((1.0 - hidden) * 1e4, (1.0 - hidden) * 1e3).asDiagonal();
  for (int k = 0; k < 20; ++k) monitor.AddDisparities(measured, information, 1e4);
}

TEST(StereoBiasMonitor, WithoutEvidenceItBelievesTheCalibrationAndCorrectsNothing) {
  const StereoBiasMonitor monitor{StereoBiasMonitor::Options()};
  EXPECT_LT(monitor.Finding(kCamera).off_probability, 0.1);
  EXPECT_EQ(monitor.correction(), DisparityBias::Zero());
  EXPECT_GT(monitor.ErrorMoment()(0, 0), 0.1 * 0.1) << "but it may be wrong";
}

TEST(StereoBiasMonitor, WhatIsFarFromZeroIsCorrected) {
  for (const double sign : {-1.0, 1.0}) {
    StereoBiasMonitor monitor{StereoBiasMonitor::Options()};
    const DisparityBias truth = sign * DisparityBias(0.8, 1.5);
    Add(monitor, truth);
    EXPECT_GT(monitor.Finding(kCamera).off_probability, 0.99);
    EXPECT_NEAR(monitor.correction()[0], truth[0], 0.02);
    EXPECT_NEAR(monitor.correction()[1], truth[1], 0.1);
    EXPECT_LT(monitor.Finding(kCamera).left_px, 0.1);
    EXPECT_NEAR(monitor.Finding(kCamera).offset_px, OffsetInImage(kCamera, truth * truth.transpose()), 0.05);
  }
}

TEST(StereoBiasMonitor, WhatIsCloseToZeroIsNotCorrectedButDoubted) {
  StereoBiasMonitor monitor{StereoBiasMonitor::Options()};
  Add(monitor, {0.08, 0.0});
  EXPECT_LT(monitor.Finding(kCamera).off_probability, 0.1);
  EXPECT_LT(monitor.correction().norm(), 0.02);
  EXPECT_GT(monitor.mean()[0], 0.04);
  EXPECT_GT(monitor.ErrorMoment()(0, 0), 0.04 * 0.04);
}

TEST(StereoBiasMonitor, WhatTheMotionHidesIsNotBelievedHoweverOftenItIsMeasured) {
  StereoBiasMonitor monitor{StereoBiasMonitor::Options()};
  for (int k = 0; k < 20; ++k) Add(monitor, {-15.0, 0.0}, 0.9999);
  EXPECT_LT(monitor.Finding(kCamera).off_probability, 0.1);
  EXPECT_LT(monitor.correction().norm(), 0.1);
}

TEST(StereoBiasMonitor, ACameraThatMovesLaterIsNoticed) {
  StereoBiasMonitor monitor{StereoBiasMonitor::Options{.memory = 50.0}};
  for (int k = 0; k < 5; ++k) Add(monitor, DisparityBias::Zero());
  EXPECT_LT(monitor.Finding(kCamera).off_probability, 0.1);
  for (int k = 0; k < 10; ++k) Add(monitor, {1.0, 1.0});
  EXPECT_GT(monitor.Finding(kCamera).off_probability, 0.99);
  EXPECT_NEAR(monitor.correction()[0], 1.0, 0.05);
}

TEST(StereoBiasMonitor, RowsAreCorrectedWhereTheyAreOff) {
  for (const double row : {-1.5, 0.05, 2.0}) {
    StereoBiasMonitor monitor{StereoBiasMonitor::Options()};
    for (int k = 0; k < 10; ++k) monitor.AddRows(std::vector<double>(30, row));
    const CalibrationFinding finding = monitor.Finding(kCamera);
    EXPECT_NEAR(finding.row_px, row, 0.05);
    EXPECT_LT(finding.row_sigma_px, 0.1);
    if (row == 0.05) {
      EXPECT_NEAR(monitor.row_correction(), 0.0, 0.01);
    } else {
      EXPECT_NEAR(monitor.row_correction(), row, 0.05);
    }
  }
}

TEST(StereoBiasMonitor, AFewPointsSayNothingAboutRows) {
  StereoBiasMonitor monitor{StereoBiasMonitor::Options()};
  for (int k = 0; k < 10; ++k) monitor.AddRows(std::vector<double>(5, 2.0));
  EXPECT_EQ(monitor.row_correction(), 0.0);
}

TEST(StereoBiasMonitor, NamesABadOption) {
  EXPECT_THROW(StereoBiasMonitor(StereoBiasMonitor::Options{.off_prior = 0.0}), std::invalid_argument);
  EXPECT_THROW(StereoBiasMonitor(StereoBiasMonitor::Options{.off_sigma_px = {0.01, 2.0}}),
               std::invalid_argument);
  EXPECT_THROW(StereoBiasMonitor(StereoBiasMonitor::Options{.memory = 0.0}), std::invalid_argument);
}

TEST(OffsetInImage, IsTheMeanOverTheColumns) {
  EXPECT_NEAR(OffsetInImage(kCamera, DisparityBias(0.8, 0.0) * Eigen::RowVector2d(0.8, 0.0)), 0.8, 1e-12);
  // The mean of x^4 over [-a, a] is a^4 / 5.
  const double a = std::tan(0.6);
  EXPECT_NEAR(OffsetInImage(kCamera, DisparityBias(0.0, 1.0) * Eigen::RowVector2d(0.0, 1.0)),
              a * a / std::sqrt(5.0), 0.005);
}

}  // namespace
}  // namespace thalweg
