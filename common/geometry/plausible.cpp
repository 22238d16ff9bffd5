#include "common/geometry/plausible.h"

#include <cmath>

#include "common/base/text.h"

namespace thalweg {
namespace {

constexpr double kRotationTolerance = 1e-3;
constexpr double kShortestFocalLength = 1e-3;  // [px]
constexpr double kLongestFocalLength = 1e6;    // [px]
constexpr double kFarthestFromImage = 1e6;     // [px]

}  // namespace

bool IsRotation(const Eigen::Matrix3d& R) {
  return R.allFinite() && (R * R.transpose()).isIdentity(kRotationTolerance) && R.determinant() > 0.0;
}

bool IsPose(const RigidTransform& T) {
  return T.translation().allFinite() && T.translation().norm() <= kFarthest && IsRotation(T.linear());
}

std::optional<std::string> MistakeIn(const PinholeCamera& camera) {
  if (camera.width_px <= 0 || camera.height_px <= 0) return "the image is empty";
  for (const double f : {camera.fx, camera.fy}) {
    if (!(f >= kShortestFocalLength && f <= kLongestFocalLength))
      return "the focal length is " + NumberText(f) + " pixels, must be 0.001 to 1000000";
  }
  for (const double c : {camera.cx, camera.cy}) {
    if (!(std::abs(c) <= kFarthestFromImage))
      return "the principal point is at " + NumberText(c) + " pixels, must be within 1000000";
  }
  return std::nullopt;
}

}  // namespace thalweg
