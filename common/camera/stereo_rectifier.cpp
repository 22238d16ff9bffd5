#include "common/camera/stereo_rectifier.h"

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

namespace thalweg {
namespace {

cv::Mat MatrixOf(const PinholeCamera& camera) {
  return (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
}

cv::Mat ToOpenCv(const Eigen::Matrix3d& R) {
  cv::Mat matrix(3, 3, CV_64F);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) matrix.at<double>(row, column) = R(row, column);
  }
  return matrix;
}

void Check(const DistortedCamera& left, const DistortedCamera& right, const RigidTransform& T_RL) {
  const auto require = [](bool holds, const std::string& text) {
    if (!holds) throw std::invalid_argument("stereo rectification: " + text);
  };
  require(
      left.pinhole.width_px == right.pinhole.width_px && left.pinhole.height_px == right.pinhole.height_px,
      "the images are of different size");
  for (const DistortedCamera* camera : {&left, &right}) {
    const PinholeCamera& p = camera->pinhole;
    require(p.width_px > 0 && p.height_px > 0, "the images have no pixels");
    require(std::isfinite(p.fx) && std::isfinite(p.fy) && p.fx > 0.0 && p.fy > 0.0,
            "focal lengths must be > 0");
    require(p.cx >= 0.0 && p.cy >= 0.0 && p.cx < p.width_px && p.cy < p.height_px,
            "the principal point lies outside the image");
    for (const double k : camera->distortion)
      require(std::isfinite(k), "a distortion coefficient is not finite");
  }
  const Eigen::Vector3d baseline = T_RL.inverse().translation();  // of the right camera in the left one
  require(T_RL.matrix().allFinite() && baseline.norm() > 1e-6, "the cameras have no baseline");
  require(baseline.x() > 0.7 * baseline.norm(), "the right camera is not to the right of the left one");
}

}  // namespace

StereoRectifier::StereoRectifier(const DistortedCamera& left, const DistortedCamera& right,
                                 const RigidTransform& T_RL) {
  Check(left, right, T_RL);
  const cv::Size size(left.pinhole.width_px, left.pinhole.height_px);
  const cv::Mat K_left = MatrixOf(left.pinhole);
  const cv::Mat K_right = MatrixOf(right.pinhole);
  const std::vector<double> d_left(left.distortion.begin(), left.distortion.end());
  const std::vector<double> d_right(right.distortion.begin(), right.distortion.end());
  const Eigen::Vector3d t_RL = T_RL.translation();
  const cv::Mat t = (cv::Mat_<double>(3, 1) << t_RL.x(), t_RL.y(), t_RL.z());
  cv::Mat R_left;
  cv::Mat R_right;
  cv::Mat P_left;
  cv::Mat P_right;
  cv::Mat Q;
  cv::stereoRectify(K_left, d_left, K_right, d_right, size, ToOpenCv(T_RL.linear()), t, R_left, R_right,
                    P_left, P_right, Q, cv::CALIB_ZERO_DISPARITY, 0.0);
  cv::initUndistortRectifyMap(K_left, d_left, R_left, P_left, size, CV_16SC2, left_maps_[0], left_maps_[1]);
  cv::initUndistortRectifyMap(K_right, d_right, R_right, P_right, size, CV_16SC2, right_maps_[0],
                              right_maps_[1]);
  geometry_.camera = {size.width,
                      size.height,
                      P_left.at<double>(0, 0),
                      P_left.at<double>(1, 1),
                      P_left.at<double>(0, 2),
                      P_left.at<double>(1, 2)};
  geometry_.baseline = -P_right.at<double>(0, 3) / P_right.at<double>(0, 0);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) R_rectified_raw_(row, column) = R_left.at<double>(row, column);
  }
}

cv::Mat StereoRectifier::Rectify(const cv::Mat& raw, const Maps& maps) const {
  if (raw.size() != maps[0].size()) {
    throw std::invalid_argument("image to rectify is " + std::to_string(raw.cols) + " x " +
                                std::to_string(raw.rows) + ", the calibration is for " +
                                std::to_string(maps[0].cols) + " x " + std::to_string(maps[0].rows));
  }
  cv::Mat result;
  cv::remap(raw, result, maps[0], maps[1], cv::INTER_LINEAR);
  return result;
}

}  // namespace thalweg
