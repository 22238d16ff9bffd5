#include "common/camera/stereo_rectifier.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "common/base/size_text.h"
#include "common/geometry/plausible.h"

namespace thalweg {
namespace {

cv::Matx33d ToCv(const Eigen::Matrix3d& m) {
  cv::Matx33d out;
  cv::eigen2cv(m, out);
  return out;
}

cv::Matx33d ToCv(const PinholeCamera& camera) {
  return {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
}

void Require(const std::optional<std::string>& mistake) {
  if (mistake) throw std::invalid_argument(*mistake);
}

}  // namespace

std::optional<std::string> MistakeIn(const Rectification& rectification, const std::string& name) {
  if (auto mistake = MistakeIn(rectification.raw, name)) return mistake;
  if (!IsRotation(rectification.R_rectified_raw)) return name + " R is not a rotation";
  return std::nullopt;
}

StereoRectifier::StereoRectifier(const StereoCalibration& calibration) {
  Require(MistakeIn(calibration));
  const RawCamera& left = calibration.left;
  const RawCamera& right = calibration.right;
  const Eigen::Vector3d& t_RL = calibration.T_RL.translation();
  std::array<cv::Matx33d, 2> R;
  std::array<cv::Matx34d, 2> P;
  cv::Matx44d Q;
  cv::stereoRectify(ToCv(left.K), left.distortion, ToCv(right.K), right.distortion,
                    {left.width_px, left.height_px}, ToCv(calibration.T_RL.linear()),
                    cv::Vec3d(t_RL.x(), t_RL.y(), t_RL.z()), R[0], R[1], P[0], P[1], Q,
                    cv::CALIB_ZERO_DISPARITY, 0.0);
  eyes_[0].rectification.raw = left;
  eyes_[1].rectification.raw = right;
  for (std::size_t i = 0; i < 2; ++i) cv::cv2eigen(R[i], eyes_[i].rectification.R_rectified_raw);
  geometry_.camera = {left.width_px, left.height_px, P[0](0, 0), P[0](1, 1), P[0](0, 2), P[0](1, 2)};
  geometry_.baseline = -P[1](0, 3) / P[1](0, 0);
  MakeTables();
}

StereoRectifier::StereoRectifier(const Rectification& left, const Rectification& right,
                                 const StereoGeometry& rectified)
    : geometry_(rectified), eyes_{{{left, {}}, {right, {}}}} {
  Require(MistakeIn(left, "left"));
  Require(MistakeIn(right, "right"));
  MakeTables();
}

void StereoRectifier::MakeTables() {
  const cv::Size size(geometry_.camera.width_px, geometry_.camera.height_px);
  for (Eye& eye : eyes_) {
    const Rectification& from = eye.rectification;
    cv::initUndistortRectifyMap(ToCv(from.raw.K), from.raw.distortion, ToCv(from.R_rectified_raw),
                                ToCv(geometry_.camera), size, CV_16SC2, eye.tables[0], eye.tables[1]);
  }
}

cv::Mat StereoRectifier::Rectify(Side side, const cv::Mat& raw) const {
  const Eye& eye = EyeAt(side);
  const RawCamera& camera = eye.rectification.raw;
  if (raw.cols != camera.width_px || raw.rows != camera.height_px) {
    throw std::invalid_argument("image to rectify is " + SizeText(raw.cols, raw.rows) +
                                ", the calibration is for " + SizeText(camera.width_px, camera.height_px));
  }
  cv::Mat result;
  cv::remap(raw, result, eye.tables[0], eye.tables[1], cv::INTER_LINEAR);
  return result;
}

Eigen::Vector2d StereoRectifier::RectifyPoint(Side side, const Eigen::Vector2d& raw) const {
  const Rectification& from = EyeAt(side).rectification;
  const std::vector<cv::Point2f> in = {{static_cast<float>(raw.x()), static_cast<float>(raw.y())}};
  std::vector<cv::Point2f> out;
  cv::undistortPoints(in, out, ToCv(from.raw.K), from.raw.distortion, ToCv(from.R_rectified_raw),
                      ToCv(geometry_.camera));
  return {out[0].x, out[0].y};
}

}  // namespace thalweg
