#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/rigid_transform.h"

namespace thalweg {

enum class Side { kLeft, kRight };

/// A real camera: a pinhole behind a lens with radial and tangential distortion [Brown, Decentering
/// Distortion of Lenses, 1966], extended as in OpenCV.
struct RawCamera {
  int width_px = 0;
  int height_px = 0;
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  /// OpenCV's order k1, k2, p1, p2, k3, ...: 0, 4, 5, 8, 12 or 14 coefficients.
  std::vector<double> distortion;
};

/// Two unrectified cameras side by side.
struct StereoCalibration {
  RawCamera left, right;
  /// [m] Pose of the left camera in the right one's frame.
  RigidTransform T_RL = RigidTransform::Identity();
};

/// Describes the first error in the camera, naming the field; nothing if it is valid.
/// @param name  The camera's name, for the text.
std::optional<std::string> MistakeIn(const RawCamera& camera, const std::string& name);
/// As above; also rejects images of different size, an invalid rotation, a missing baseline, and cameras that
/// are stacked vertically or swapped.
std::optional<std::string> MistakeIn(const StereoCalibration& calibration);

}  // namespace thalweg
