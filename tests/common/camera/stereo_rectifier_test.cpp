#include "common/camera/stereo_rectifier.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace thalweg {
namespace {

RawCamera Lens(double cx, double cy, double k1) {
  RawCamera camera{640, 480, {}, {k1, 0.07, 2e-4, -1e-4, 0.0}};
  camera.K << 430.0, 0.0, cx, 0.0, 428.0, cy, 0.0, 0.0, 1.0;
  return camera;
}

/// Cameras 11 cm apart and not quite parallel, the right one slightly behind and below.
RigidTransform RightFromLeft() {
  const Eigen::Matrix3d R_RL = (Eigen::AngleAxisd(0.012, Eigen::Vector3d::UnitX()) *
                                Eigen::AngleAxisd(-0.018, Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(0.007, Eigen::Vector3d::UnitZ()))
                                   .toRotationMatrix();
  const RigidTransform T_LR = MakeTransform(R_RL.transpose(), Eigen::Vector3d(0.11, 0.002, -0.003));
  return T_LR.inverse();
}

/// Brown's distortion model as in a textbook.
Eigen::Vector2d Distort(const RawCamera& camera, const Eigen::Vector3d& p) {
  const double k1 = camera.distortion[0];
  const double k2 = camera.distortion[1];
  const double p1 = camera.distortion[2];
  const double p2 = camera.distortion[3];
  const double k3 = camera.distortion[4];
  const double x = p.x() / p.z();
  const double y = p.y() / p.z();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double xd = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  const double yd = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  return {camera.K(0, 0) * xd + camera.K(0, 2), camera.K(1, 1) * yd + camera.K(1, 2)};
}

/// Draws a blurred spot on black; below, the centroid of an image.
cv::Mat Spot(const Eigen::Vector2d& at) {
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(0));
  for (int v = std::max(0, static_cast<int>(at.y()) - 12); v < std::min(480, static_cast<int>(at.y()) + 13);
       ++v) {
    for (int u = std::max(0, static_cast<int>(at.x()) - 12); u < std::min(640, static_cast<int>(at.x()) + 13);
         ++u) {
      const double d2 = (Eigen::Vector2d(u, v) - at).squaredNorm();
      image.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(std::lround(250.0 * std::exp(-d2 / 12.0)));
    }
  }
  return image;
}

Eigen::Vector2d Weight(const cv::Mat& image) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double total = 0.0;
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const double value = image.at<std::uint8_t>(v, u);
      sum += value * Eigen::Vector2d(u, v);
      total += value;
    }
  }
  return sum / total;
}

const std::vector<Eigen::Vector3d> kPoints = {
    {0.1, 0.05, 1.5}, {-0.8, 0.5, 2.5}, {1.2, -0.7, 3.0}, {0.0, 0.6, 2.0}};

class RectifierOfACrookedPair : public testing::Test {
 protected:
  void ExpectPointsWhereAnIdealPairSeesThem(const StereoRectifier& rectifier) const {
    const StereoGeometry& ideal = rectifier.geometry();
    const PinholeCamera& camera = ideal.camera;
    for (const Eigen::Vector3d& p_raw : kPoints) {
      const Eigen::Vector2d in_left = Distort(c_.left, p_raw);
      const Eigen::Vector2d in_right = Distort(c_.right, c_.T_RL * p_raw);
      const Eigen::Vector2d seen_left = Weight(rectifier.Rectify(Side::kLeft, Spot(in_left)));
      const Eigen::Vector2d seen_right = Weight(rectifier.Rectify(Side::kRight, Spot(in_right)));
      const Eigen::Vector3d p = rectifier.R_rectified_raw() * p_raw;
      const Eigen::Vector2d expected(camera.fx * p.x() / p.z() + camera.cx,
                                     camera.fy * p.y() / p.z() + camera.cy);
      EXPECT_LT((seen_left - expected).norm(), 0.2) << p_raw.transpose();
      EXPECT_NEAR(seen_left.y(), seen_right.y(), 0.2) << "rows are aligned";
      EXPECT_NEAR(seen_left.x() - seen_right.x(), camera.fx * ideal.baseline / p.z(), 0.25);
      const Eigen::Vector2d point_left = rectifier.RectifyPoint(Side::kLeft, in_left);
      const Eigen::Vector2d point_right = rectifier.RectifyPoint(Side::kRight, in_right);
      EXPECT_LT((point_left - expected).norm(), 0.01);
      EXPECT_NEAR(point_left.y(), point_right.y(), 0.01);
      EXPECT_NEAR(point_left.x() - point_right.x(), camera.fx * ideal.baseline / p.z(), 0.01);
    }
  }
  const StereoCalibration c_{Lens(330.0, 247.0, -0.28), Lens(318.0, 239.0, -0.27), RightFromLeft()};
};

TEST_F(RectifierOfACrookedPair, PutsPointsWhereAnIdealPairSeesThem) {
  const StereoRectifier rectifier(c_);
  EXPECT_NEAR(rectifier.geometry().baseline, c_.T_RL.inverse().translation().norm(), 1e-9);
  ExpectPointsWhereAnIdealPairSeesThem(rectifier);
}

/// Any rotation about the baseline keeps it the x axis of both cameras; this is one that OpenCV does not
/// choose.
TEST_F(RectifierOfACrookedPair, AppliesARectificationFoundElsewhere) {
  const Eigen::Vector3d x = c_.T_RL.inverse().translation().normalized();
  const Eigen::Vector3d y = Eigen::Vector3d(0.03, 0.1, 1.0).cross(x).normalized();
  Eigen::Matrix3d R_rectified_left;
  R_rectified_left << x.transpose(), y.transpose(), x.cross(y).transpose();
  const StereoGeometry geometry{{600, 440, 400.0, 400.0, 300.0, 200.0},
                                c_.T_RL.inverse().translation().norm()};
  const StereoRectifier rectifier({c_.left, R_rectified_left},
                                  {c_.right, R_rectified_left * c_.T_RL.linear().transpose()}, geometry);
  EXPECT_EQ(rectifier.R_rectified_raw(), R_rectified_left);
  ExpectPointsWhereAnIdealPairSeesThem(rectifier);
}

TEST(StereoRectifier, LeavesAnIdealPairAsItIs) {
  RawCamera camera = Lens(319.5, 239.5, 0.0);
  camera.distortion.clear();
  camera.K(1, 1) = camera.K(0, 0);
  const StereoRectifier rectifier(
      StereoCalibration{camera, camera, MakeTransform(Eigen::Matrix3d::Identity(), {-0.12, 0, 0})});
  EXPECT_NEAR(rectifier.geometry().baseline, 0.12, 1e-12);
  EXPECT_NEAR(rectifier.geometry().camera.fx, camera.K(0, 0), 1e-9);
  EXPECT_TRUE(rectifier.R_rectified_raw().isIdentity(1e-12));
  const cv::Mat spot = Spot({211.0, 133.0});
  EXPECT_EQ(cv::norm(rectifier.Rectify(Side::kLeft, spot), spot, cv::NORM_INF), 0.0);
}

TEST(StereoRectifier, RefusesImagesOfAnotherSizeNamingBoth) {
  const StereoRectifier rectifier(
      StereoCalibration{Lens(320.0, 240.0, 0.0), Lens(320.0, 240.0, 0.0), RightFromLeft()});
  EXPECT_THAT([&] { rectifier.Rectify(Side::kLeft, cv::Mat(100, 90, CV_8UC1)); },
              testing::ThrowsMessage<std::invalid_argument>(
                  testing::AllOf(testing::HasSubstr("90 x 100"), testing::HasSubstr("640 x 480"))));
}

TEST(StereoRectifier, NamesWhatDoesNotFit) {
  const auto mistake = [](auto&& change) {
    StereoCalibration c{Lens(320.0, 240.0, 0.1), Lens(320.0, 240.0, 0.1), RightFromLeft()};
    change(c);
    try {
      const StereoRectifier rectifier(c);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(mistake([](auto&) {}), "taken");
  EXPECT_EQ(mistake([](auto& c) { c.left.K(0, 2) = kNan; }), "left K contains a non-finite value");
  EXPECT_EQ(mistake([](auto& c) { c.right.K(0, 0) = -1.0; }), "right K has a focal length that is not > 0");
  EXPECT_EQ(mistake([](auto& c) { c.right.K(2, 0) = 1.0; }),
            "right K is not a camera matrix: its lower part must be 0 and its last row 0, 0, 1");
  EXPECT_EQ(mistake([](auto& c) { c.left.K(0, 2) = 900.0; }),
            "left K has its principal point outside the image of 640 x 480");
  EXPECT_EQ(mistake([](auto& c) { c.right.distortion[1] = kNan; }), "right D contains a non-finite value");
  EXPECT_EQ(mistake([](auto& c) { c.left.distortion.resize(3); }),
            "left D has 3 numbers, must have 0, 4, 5, 8, 12 or 14");
  EXPECT_EQ(mistake([](auto& c) { c.right.width_px = 0; }),
            "right image size is 0 x 480, must be 2 to 65536");
  EXPECT_EQ(mistake([](auto& c) { c.right.width_px = 512; }),
            "the images differ in size: left 640 x 480, right 512 x 480");
  EXPECT_EQ(mistake([](auto& c) { c.T_RL.linear()(0, 0) = 2.0; }), "R is not a rotation");
  EXPECT_EQ(mistake([](auto& c) { c.T_RL.linear().col(0) *= -1.0; }), "R is not a rotation");
  EXPECT_EQ(mistake([](auto& c) { c.T_RL.translation().y() = kNan; }), "T contains a non-finite value");
  EXPECT_EQ(mistake([](auto& c) { c.T_RL.translation().setZero(); }), "T is 0: the cameras have no baseline");
  const std::string swapped =
      "T does not put the right camera to the right of the left one: are they swapped?";
  EXPECT_EQ(mistake([](auto& c) { c.T_RL.translation() *= -1.0; }), swapped);
  EXPECT_EQ(mistake([](auto& c) { c.T_RL.translation() = Eigen::Vector3d(-0.1, -0.11, 0.0); }), swapped);
  EXPECT_EQ(mistake([](auto& c) { c.T_RL.translation() = Eigen::Vector3d(-0.1, 0.0, 0.11); }), swapped);
  const Rectification good{Lens(320.0, 240.0, 0.1), Eigen::Matrix3d::Identity()};
  const Rectification bad{good.raw, 2.0 * Eigen::Matrix3d::Identity()};
  EXPECT_THAT(
      [&] {
        StereoRectifier(good, bad, {{640, 480, 1.0, 1.0, 1.0, 1.0}, 0.1});
      },
      testing::ThrowsMessage<std::invalid_argument>("right R is not a rotation"));
}

}  // namespace
}  // namespace thalweg
