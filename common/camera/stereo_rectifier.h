#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "common/camera/stereo_calibration.h"
#include "common/geometry/stereo_geometry.h"

namespace thalweg {

/// How the images of one raw camera are rectified.
struct Rectification {
  RawCamera raw;
  Eigen::Matrix3d R_rectified_raw = Eigen::Matrix3d::Identity();  ///< Rectification only rotates the camera.
};

/// Describes the first error, naming the field; nothing if it is valid.
/// @param name  The camera's name, for the text.
std::optional<std::string> MistakeIn(const Rectification& rectification, const std::string& name);

/// Converts the images of two raw cameras into those of an ideal rectified pair, without distortion and with
/// aligned rows, using lookup tables computed once.
///
/// Threading: Rectify is const and may be called from any thread.
class StereoRectifier {
 public:
  /// Computes the rectification [Fusiello, Trucco, Verri 2000; as OpenCV's stereoRectify: disparity 0 at
  /// infinity, scaled so that all pixels are valid where possible]. Throws std::invalid_argument with
  /// MistakeIn's text.
  explicit StereoRectifier(const StereoCalibration& calibration);
  /// Uses a rectification computed elsewhere. Throws std::invalid_argument with MistakeIn's text.
  StereoRectifier(const Rectification& left, const Rectification& right, const StereoGeometry& rectified);

  const StereoGeometry& geometry() const { return geometry_; }
  const RawCamera& raw(Side side) const { return EyeAt(side).rectification.raw; }
  /// Rotates vectors from the raw left camera's axes to the rectified ones; the origin is the same.
  const Eigen::Matrix3d& R_rectified_raw() const { return eyes_[0].rectification.R_rectified_raw; }

  /// Rectifies an image with bilinear interpolation; pixels outside the raw image's view are black. Throws
  /// std::invalid_argument naming both sizes if `raw` is not of the raw camera's size.
  /// @param raw  Any depth and number of channels.
  cv::Mat Rectify(Side side, const cv::Mat& raw) const;
  /// Position in the rectified image of a point of the raw image, both in [px].
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
