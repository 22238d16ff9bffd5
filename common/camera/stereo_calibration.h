#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/rigid_transform.h"

namespace thalweg {

enum class Side { kLeft, kRight };

/// A real camera: a pinhole behind a lens with radial and tangential distortion [Brown, Decentering
/// Distortion of Lenses, 1966], and what OpenCV adds to that.
struct RawCamera {
  int width_px = 0;
  int height_px = 0;
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  std::vector<double> distortion;  ///< k1, k2, p1, p2, k3, ...: 0, 4, 5, 8, 12 or 14 numbers.
};

/// Two raw cameras side by side.
struct StereoCalibration {
  RawCamera left, right;
  RigidTransform T_RL = RigidTransform::Identity();  ///< Pose of the left one in the right one, [m].
};

/// What is wrong with it, naming the field; none when nothing is. @param name  Of the camera, for the text.
std::optional<std::string> MistakeIn(const RawCamera& camera, const std::string& name);
/// As above, and: sizes that differ, no rotation, no baseline, cameras one above the other or swapped.
std::optional<std::string> MistakeIn(const StereoCalibration& calibration);

/// Up to rounding in the digits of a file.
bool IsRotation(const Eigen::Matrix3d& R);

}  // namespace thalweg
