#include "services/stereo/core/calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/support/random_images.h"

namespace thalweg::stereo {
namespace {

using testing::HasSubstr;

StereoCalibration Example() {
  StereoCalibration c;
  c.left = {320, 240, Eigen::Matrix3d::Identity(), {-0.2, 0.05, 0.001, -0.0005, 0.0}};
  c.left.K << 250, 0, 158, 0, 252, 121, 0, 0, 1;
  c.right = {320, 240, Eigen::Matrix3d::Identity(), {-0.22, 0.06, 0.0, 0.001, 0.0}};
  c.right.K << 255, 0, 163, 0, 254, 118, 0, 0, 1;
  const Eigen::Quaterniond q_RL =
      Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(-0.02, Eigen::Vector3d::UnitX());
  c.T_RL = MakeTransform(q_RL.toRotationMatrix(), {-0.1, 0.003, -0.002});
  return c;
}

/// OpenCV's lens model, implemented independently.
Eigen::Vector2d Project(const RawCamera& camera, const Eigen::Vector3d& p) {
  const auto& k = camera.distortion;
  const double x = p.x() / p.z();
  const double y = p.y() / p.z();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + k[0] * r2 + k[1] * r2 * r2 + k[4] * r2 * r2 * r2;
  const double xd = x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x);
  const double yd = y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y;
  return {camera.K(0, 0) * xd + camera.K(0, 2), camera.K(1, 1) * yd + camera.K(1, 2)};
}

TEST(Rectify, LeavesThePairOfAnIdealCamera) {
  StereoCalibration c;
  c.left = {320, 240, Eigen::Matrix3d::Identity(), {}};
  c.left.K << 250, 0, 158, 0, 250, 121, 0, 0, 1;
  c.right = c.left;
  c.T_RL.translation() = Eigen::Vector3d(-0.1, 0.0, 0.0);
  const StereoRectifier rectifier(c);
  for (const int channels : {1, 3}) {
    const ByteImage image = test::RandomImage(320, 240, 1, channels);
    EXPECT_EQ(Rectify(rectifier, Side::kLeft, image), image);
    EXPECT_EQ(Rectify(rectifier, Side::kRight, image), image);
  }
}

TEST(Calibrate, FindsTheCamerasThatSawTheBoards) {
  const StereoCalibration truth = Example();
  const Board board{.columns = 8, .rows = 5, .square = 0.04};
  std::vector<BoardView> views;
  for (int k = 0; k < 12; ++k) {
    const Eigen::Isometry3d T_LB = Eigen::Translation3d(-0.15 + 0.02 * (k % 5), -0.1 + 0.02 * (k % 3), 0.7) *
                                   Eigen::AngleAxisd(0.1 * (k % 5) - 0.2, Eigen::Vector3d::UnitX()) *
                                   Eigen::AngleAxisd(0.12 * (k % 4) - 0.2, Eigen::Vector3d::UnitY());
    BoardView view;
    for (int j = 0; j < board.rows; ++j) {
      for (int i = 0; i < board.columns; ++i) {
        const Eigen::Vector3d p_L = T_LB * Eigen::Vector3d(i * board.square, j * board.square, 0.0);
        view.left.push_back(Project(truth.left, p_L).cast<float>());
        view.right.push_back(Project(truth.right, truth.T_RL * p_L).cast<float>());
      }
    }
    views.push_back(view);
  }
  const CalibrationResult result = Calibrate(views, board, truth.left.width_px, truth.left.height_px);
  EXPECT_LT(result.reprojection_px, 0.01);
  EXPECT_LT(result.epipolar_px, 0.01);
  EXPECT_NEAR(result.calibration.left.K(0, 0), truth.left.K(0, 0), 0.5);
  EXPECT_NEAR(result.calibration.right.K(1, 2), truth.right.K(1, 2), 0.5);
  EXPECT_LT((result.calibration.T_RL.translation() - truth.T_RL.translation()).norm(), 1e-3);
  EXPECT_LT((result.calibration.T_RL.linear() - truth.T_RL.linear()).norm(), 1e-3);
}

TEST(Calibrate, NeedsThreeViews) {
  EXPECT_THAT([] { Calibrate({}, {}, 10, 10); },
              testing::ThrowsMessage<std::invalid_argument>(HasSubstr("at least 3")));
}

}  // namespace
}  // namespace thalweg::stereo
