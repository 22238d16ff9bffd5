#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "common/camera/stereo_calibration.h"
#include "common/geometry/stereo_geometry.h"

namespace thalweg {

/// How the images of one raw camera become rectified ones.
struct Rectification {
  RawCamera raw;
  Eigen::Matrix3d R_rectified_raw = Eigen::Matrix3d::Identity();  ///< The camera is only turned.
};

/// What is wrong with it, naming the field; none when nothing is. @param name  Of the camera, for the text.
std::optional<std::string> MistakeIn(const Rectification& rectification, const std::string& name);

/// Makes, of the images of two raw cameras, those of an ideal rectified pair: without distortion, rows
/// aligned, through tables that are made once. Threading: Rectify is const and may run on any thread.
class StereoRectifier {
 public:
  /// Finds the rectification [Fusiello, Trucco, Verri 2000; as in OpenCV's stereoRectify, zero disparity at
  /// infinity, no unseen pixels where it can be had].
  /// Throws std::invalid_argument with MistakeIn's text.
  explicit StereoRectifier(const StereoCalibration& calibration);
  /// Applies one that was found elsewhere.
  /// Throws std::invalid_argument with MistakeIn's text.
  StereoRectifier(const Rectification& left, const Rectification& right, const StereoGeometry& rectified);

  const StereoGeometry& geometry() const { return geometry_; }
  const RawCamera& raw(Side side) const { return EyeAt(side).rectification.raw; }
  /// The raw left camera's axes as the rectified one sees them; the origin stays.
  const Eigen::Matrix3d& R_rectified_raw() const { return eyes_[0].rectification.R_rectified_raw; }

  /// @param raw  Of the size of the raw camera, any depth and channels. Bilinear; pixels that no ray of the
  /// raw image reaches are black. Throws std::invalid_argument naming both sizes when they differ.
  cv::Mat Rectify(Side side, const cv::Mat& raw) const;
  /// Where a pixel of the raw image comes to lie.
  Eigen::Vector2d RectifyPoint(Side side, const Eigen::Vector2d& raw) const;

 private:
  struct Eye {
    Rectification rectification;
    std::array<cv::Mat, 2> tables;
  };
  const Eye& EyeAt(Side side) const { return eyes_[side == Side::kLeft ? 0 : 1]; }
  void MakeTables();

  StereoGeometry geometry_;
  std::array<Eye, 2> eyes_;
};

}  // namespace thalweg
