#include "common/camera/stereo_calibration.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/base/size_text.h"
#include "common/geometry/plausible.h"

namespace thalweg {
namespace {

constexpr int kWidest = 65536;  // [px]
constexpr double kLeastBaseline = 1e-6;  // [m]
constexpr std::array<std::size_t, 6> kDistortionCounts = {0, 4, 5, 8, 12, 14};

std::string SizeOf(const RawCamera& camera) {
  return SizeText(camera.width_px, camera.height_px);
}

}  // namespace

std::optional<std::string> MistakeIn(const RawCamera& camera, const std::string& name) {
  if (camera.width_px < 2 || camera.height_px < 2 || camera.width_px > kWidest ||
      camera.height_px > kWidest) {
    return name + " image size is " + SizeOf(camera) + ", must be 2 to 65536";
  }
  const Eigen::Matrix3d& K = camera.K;
  if (!K.allFinite()) return name + " K contains a non-finite value";
  if (K(0, 0) <= 0.0 || K(1, 1) <= 0.0) return name + " K has a focal length that is not > 0";
  if (K(1, 0) != 0.0 || K.row(2) != Eigen::RowVector3d(0.0, 0.0, 1.0)) {
    return name + " K is not a camera matrix: its lower part must be 0 and its last row 0, 0, 1";
  }
  if (K(0, 2) < 0.0 || K(1, 2) < 0.0 || K(0, 2) >= camera.width_px || K(1, 2) >= camera.height_px) {
    return name + " K has its principal point outside the image of " + SizeOf(camera);
  }
  const std::size_t count = camera.distortion.size();
  if (std::find(kDistortionCounts.begin(), kDistortionCounts.end(), count) == kDistortionCounts.end()) {
    return name + " D has " + std::to_string(count) + " numbers, must have 0, 4, 5, 8, 12 or 14";
  }
  for (const double value : camera.distortion) {
    if (!std::isfinite(value)) return name + " D contains a non-finite value";
  }
  return std::nullopt;
}

std::optional<std::string> MistakeIn(const StereoCalibration& calibration) {
  const RawCamera& left = calibration.left;
  const RawCamera& right = calibration.right;
  if (auto mistake = MistakeIn(left, "left")) return mistake;
  if (auto mistake = MistakeIn(right, "right")) return mistake;
  if (left.width_px != right.width_px || left.height_px != right.height_px) {
    return "the images differ in size: left " + SizeOf(left) + ", right " + SizeOf(right);
  }
  if (!IsRotation(calibration.T_RL.linear())) return "R is not a rotation";
  if (!calibration.T_RL.translation().allFinite()) return "T contains a non-finite value";
  const Eigen::Vector3d right_in_left = calibration.T_RL.inverse().translation();
  if (right_in_left.norm() <= kLeastBaseline) return "T is 0: the cameras have no baseline";
  if (right_in_left.x() < std::numbers::sqrt2 / 2.0 * right_in_left.norm()) {
    return "T does not put the right camera to the right of the left one: are they swapped?";
  }
  return std::nullopt;
}

}  // namespace thalweg
