#include "common/camera/stereo_rectifier.h"

#include <gtest/gtest.h>

#include <cmath>

namespace thalweg {
namespace {

DistortedCamera Lens(double cx, double cy, double k1) {
  DistortedCamera camera;
  camera.pinhole = {640, 480, 430.0, 428.0, cx, cy};
  camera.distortion = {k1, 0.07, 2e-4, -1e-4, 0.0};
  return camera;
}

/// Cameras 11 cm apart, not quite parallel, the right one a little behind and below.
RigidTransform RightFromLeft() {
  const Eigen::Matrix3d R_RL = (Eigen::AngleAxisd(0.012, Eigen::Vector3d::UnitX()) *
                                Eigen::AngleAxisd(-0.018, Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(0.007, Eigen::Vector3d::UnitZ()))
                                   .toRotationMatrix();
  const RigidTransform T_LR = MakeTransform(R_RL.transpose(), Eigen::Vector3d(0.11, 0.002, -0.003));
  return T_LR.inverse();
}

/// Brown's model, as a textbook writes it.
Eigen::Vector2d Distort(const DistortedCamera& camera, const Eigen::Vector3d& p) {
  const auto& [k1, k2, p1, p2, k3] = camera.distortion;
  const double x = p.x() / p.z();
  const double y = p.y() / p.z();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double xd = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  const double yd = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  return {camera.pinhole.fx * xd + camera.pinhole.cx, camera.pinhole.fy * yd + camera.pinhole.cy};
}

/// A soft spot on black, and where the weight of an image lies.
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

TEST(StereoRectifier, PutsPointsWhereAnIdealPairSeesThem) {
  const DistortedCamera left = Lens(330.0, 247.0, -0.28);
  const DistortedCamera right = Lens(318.0, 239.0, -0.27);
  const RigidTransform T_RL = RightFromLeft();
  const StereoRectifier rectifier(left, right, T_RL);
  const StereoGeometry& ideal = rectifier.geometry();
  EXPECT_NEAR(ideal.baseline, T_RL.inverse().translation().norm(), 1e-9);
  for (const Eigen::Vector3d& p_raw : {Eigen::Vector3d(0.1, 0.05, 1.5), Eigen::Vector3d(-0.8, 0.5, 2.5),
                                       Eigen::Vector3d(1.2, -0.7, 3.0), Eigen::Vector3d(0.0, 0.6, 2.0)}) {
    const Eigen::Vector2d seen_left = Weight(rectifier.RectifyLeft(Spot(Distort(left, p_raw))));
    const Eigen::Vector2d seen_right = Weight(rectifier.RectifyRight(Spot(Distort(right, T_RL * p_raw))));
    const Eigen::Vector3d p = rectifier.R_rectified_raw() * p_raw;
    const PinholeCamera& camera = ideal.camera;
    const Eigen::Vector2d expected(camera.fx * p.x() / p.z() + camera.cx,
                                   camera.fy * p.y() / p.z() + camera.cy);
    EXPECT_LT((seen_left - expected).norm(), 0.2) << p_raw.transpose();
    EXPECT_NEAR(seen_left.y(), seen_right.y(), 0.2) << "rows are aligned";
    EXPECT_NEAR(seen_left.x() - seen_right.x(), camera.fx * ideal.baseline / p.z(), 0.25);
  }
}

TEST(StereoRectifier, LeavesAnIdealPairAsItIs) {
  DistortedCamera camera = Lens(319.5, 239.5, 0.0);
  camera.distortion = {};
  camera.pinhole.fy = camera.pinhole.fx;
  const StereoRectifier rectifier(camera, camera, MakeTransform(Eigen::Matrix3d::Identity(), {-0.12, 0, 0}));
  EXPECT_NEAR(rectifier.geometry().baseline, 0.12, 1e-12);
  EXPECT_NEAR(rectifier.geometry().camera.fx, camera.pinhole.fx, 1e-9);
  EXPECT_TRUE(rectifier.R_rectified_raw().isIdentity(1e-12));
  const cv::Mat spot = Spot({211.0, 133.0});
  EXPECT_LE(cv::norm(rectifier.RectifyLeft(spot), spot, cv::NORM_INF), 1.0);
}

TEST(StereoRectifier, NamesWhatDoesNotFit) {
  const DistortedCamera camera = Lens(320.0, 240.0, 0.0);
  const auto reason = [](const DistortedCamera& left, const DistortedCamera& right,
                         const RigidTransform& T_RL) {
    try {
      const StereoRectifier rectifier(left, right, T_RL);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  EXPECT_NE(reason(camera, camera, RightFromLeft().inverse()).find("not to the right"), std::string::npos);
  EXPECT_NE(reason(camera, camera, RigidTransform::Identity()).find("no baseline"), std::string::npos);
  DistortedCamera other = camera;
  other.pinhole.width_px = 512;
  EXPECT_NE(reason(camera, other, RightFromLeft()).find("different size"), std::string::npos);
  other = camera;
  other.pinhole.cx = 900.0;
  EXPECT_NE(reason(camera, other, RightFromLeft()).find("principal point"), std::string::npos);
  const StereoRectifier good(camera, camera, RightFromLeft());
  EXPECT_THROW(good.RectifyLeft(cv::Mat(100, 100, CV_8UC1)), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg
