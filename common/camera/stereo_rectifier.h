#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "common/geometry/rigid_transform.h"
#include "common/geometry/stereo_geometry.h"

namespace thalweg {

/// A real camera: a pinhole behind a lens with radial and tangential distortion ("plumb bob") [Brown,
/// Decentering Distortion of Lenses, 1966].
struct DistortedCamera {
  PinholeCamera pinhole;
  std::array<double, 5> distortion{};  ///< k1, k2, p1, p2, k3
};

/// Makes, of the images of two real cameras, those of an ideal rectified pair: without distortion, rows
/// aligned [Fusiello, Trucco, Verri 2000; as in OpenCV's stereoRectify, zero disparity at infinity, no unseen
/// pixels where it can be had]. Threading: Rectify is const and may run on any thread.
class StereoRectifier {
 public:
  /// @param T_RL  Pose of the left raw camera in the right one.
  /// Throws std::invalid_argument naming what does not fit: sizes that differ, focal lengths, no baseline,
  /// cameras one above the other or swapped.
  StereoRectifier(const DistortedCamera& left, const DistortedCamera& right, const RigidTransform& T_RL);

  const StereoGeometry& geometry() const { return geometry_; }
  /// The raw left camera's axes as the rectified one sees them; the origin stays.
  const Eigen::Matrix3d& R_rectified_raw() const { return R_rectified_raw_; }

  /// @param raw  Of the size of the cameras, any depth and channels. Pixels that no ray of the raw image
  /// reaches are black.
  cv::Mat RectifyLeft(const cv::Mat& raw) const { return Rectify(raw, left_maps_); }
  cv::Mat RectifyRight(const cv::Mat& raw) const { return Rectify(raw, right_maps_); }

 private:
  using Maps = std::array<cv::Mat, 2>;
  cv::Mat Rectify(const cv::Mat& raw, const Maps& maps) const;

  StereoGeometry geometry_;
  Eigen::Matrix3d R_rectified_raw_;
  Maps left_maps_;
  Maps right_maps_;
};

}  // namespace thalweg
