#include "services/stereo/core/calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "tests/services/stereo/core/random_images.h"

namespace thalweg::stereo {
namespace {

using testing::HasSubstr;

StereoCalibration Example() {
  StereoCalibration c;
  c.width_px = 320;
  c.height_px = 240;
  c.left.K << 250, 0, 158, 0, 252, 121, 0, 0, 1;
  c.right.K << 255, 0, 163, 0, 254, 118, 0, 0, 1;
  c.left.distortion = {-0.2, 0.05, 0.001, -0.0005, 0.0};
  c.right.distortion = {-0.22, 0.06, 0.0, 0.001, 0.0};
  c.R =
      (Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(-0.02, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  c.T = {-0.1, 0.003, -0.002};
  return c;
}

/// OpenCV's model of a lens, written down once more.
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

TEST(Rectifier, PointsOfTheWorldLieOnOneRowAndTriangulateToTheirDepth) {
  const StereoCalibration c = Example();
  const Rectifier rectifier(c);
  EXPECT_NEAR(rectifier.camera().baseline, c.T.norm(), 1e-9);
  std::vector<double> depths_by_disparity;
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d p_L(0.6 * std::sin(i), 0.4 * std::cos(1.7 * i), 1.5 + 0.05 * i);
    const Eigen::Vector3d p_R = c.R * p_L + c.T;
    const Eigen::Vector2d left = rectifier.RectifyPoint(Side::kLeft, Project(c.left, p_L));
    const Eigen::Vector2d right = rectifier.RectifyPoint(Side::kRight, Project(c.right, p_R));
    EXPECT_NEAR(left.y(), right.y(), 0.01);
    const double z = rectifier.camera().camera.fx * rectifier.camera().baseline / (left.x() - right.x());
    const Eigen::Vector3d p = rectifier.camera().camera.RayAtUnitDepth(left.x(), left.y()) * z;
    EXPECT_NEAR(p.norm(), p_L.norm(), 0.002 * p_L.norm());  // the rectified frame is only turned
  }
}

TEST(Rectifier, LeavesThePairOfAnIdealCamera) {
  StereoCalibration c = Example();
  c.left = {};
  c.left.K << 250, 0, 158, 0, 250, 121, 0, 0, 1;
  c.right = c.left;
  c.R.setIdentity();
  c.T = {-0.1, 0.0, 0.0};
  const Rectifier rectifier(c);
  const ByteImage image = test::RandomImage(320, 240, 1, 3);
  EXPECT_EQ(rectifier.Rectify(Side::kLeft, image), image);
  EXPECT_EQ(rectifier.Rectify(Side::kRight, image), image);
  EXPECT_NEAR(rectifier.camera().camera.fx, 250.0, 1e-9);
  EXPECT_NEAR(rectifier.camera().camera.cy, 121.0, 1e-9);
}

TEST(Rectifier, RefusesImagesOfAnotherSize) {
  const Rectifier rectifier(Example());
  EXPECT_THAT([&] { rectifier.Rectify(Side::kLeft, ByteImage(320, 241)); },
              testing::ThrowsMessage<std::invalid_argument>(
                  testing::AllOf(HasSubstr("320 x 241"), HasSubstr("320 x 240"))));
}

TEST(MistakeIn, NamesTheField) {
  EXPECT_FALSE(MistakeIn(Example()));
  const auto mistake = [](auto&& change) {
    StereoCalibration c = Example();
    change(c);
    return MistakeIn(c).value_or("none");
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(mistake([](auto& c) { c.left.K(0, 2) = kNan; }), HasSubstr("K1"));
  EXPECT_THAT(mistake([](auto& c) { c.right.K(0, 0) = -1.0; }), HasSubstr("K2"));
  EXPECT_THAT(mistake([](auto& c) { c.right.distortion[1] = kNan; }), HasSubstr("D2"));
  EXPECT_THAT(mistake([](auto& c) { c.left.distortion.resize(3); }), HasSubstr("D1"));
  EXPECT_THAT(mistake([](auto& c) { c.R(0, 0) = 2.0; }), HasSubstr("R"));
  EXPECT_THAT(mistake([](auto& c) { c.T = -c.T; }), HasSubstr("T"));
  EXPECT_THAT(mistake([](auto& c) { c.width_px = 0; }), HasSubstr("0 x 240"));
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
        view.right.push_back(Project(truth.right, truth.R * p_L + truth.T).cast<float>());
      }
    }
    views.push_back(view);
  }
  const CalibrationResult result = Calibrate(views, board, truth.width_px, truth.height_px);
  EXPECT_LT(result.reprojection_px, 0.01);
  EXPECT_LT(result.epipolar_px, 0.01);
  EXPECT_NEAR(result.calibration.left.K(0, 0), truth.left.K(0, 0), 0.5);
  EXPECT_NEAR(result.calibration.right.K(1, 2), truth.right.K(1, 2), 0.5);
  EXPECT_LT((result.calibration.T - truth.T).norm(), 1e-3);
  EXPECT_LT((result.calibration.R - truth.R).norm(), 1e-3);
}

TEST(Calibrate, NeedsThreeViews) {
  EXPECT_THAT([] { Calibrate({}, {}, 10, 10); },
              testing::ThrowsMessage<std::invalid_argument>(HasSubstr("at least 3")));
}

}  // namespace
}  // namespace thalweg::stereo
