#pragma once

#include <optional>
#include <string>

#include "common/geometry/pinhole_camera.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg {

/// [m] Nothing is farther away, neither the robot from its map's origin nor a surface from a camera: numbers
/// beyond are errors, which would overflow what is computed with them.
inline constexpr double kFarthest = 1e6;

/// Whether R is a rotation, with a tolerance for the rounding of numbers in a file.
bool IsRotation(const Eigen::Matrix3d& R);
/// Whether it is a rotation and a translation of at most kFarthest.
bool IsPose(const RigidTransform& T);

/// Describes the first error of a camera, naming the field; nothing if it is valid. A focal length is a
/// number from a thousandth of a pixel to a million pixels; the principal point is not farther away than
/// that.
std::optional<std::string> MistakeIn(const PinholeCamera& camera);

}  // namespace thalweg
