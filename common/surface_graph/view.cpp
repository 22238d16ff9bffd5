#include "common/surface_graph/view.h"

#include <limits>

#include "common/base/size_text.h"
#include "common/base/text.h"
#include "common/camera/stereo_calibration.h"

namespace thalweg::surface {

std::optional<std::string> MistakeIn(const View& view) {
  const PinholeCamera& camera = view.rig.camera;
  if (camera.width_px <= 0 || camera.height_px <= 0) return "the image is empty";
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  if (!positive(camera.fx) || !positive(camera.fy)) return "the focal length is not a positive number";
  if (!std::isfinite(camera.cx) || !std::isfinite(camera.cy)) return "the principal point is not finite";
  if (!positive(view.rig.baseline)) {
    return "the baseline is " + NumberText(view.rig.baseline) + ", must be positive";
  }
  const auto pixels = static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
  const std::string size = SizeText(camera.width_px, camera.height_px);
  if (view.disparities.size() != pixels) {
    return std::to_string(view.disparities.size()) + " disparities for a camera of " + size;
  }
  if (!view.colors.empty() && view.colors.size() != pixels) {
    return std::to_string(view.colors.size()) + " colors for a camera of " + size;
  }
  if (!view.T_WC.translation().allFinite() || !IsRotation(view.T_WC.linear())) {
    return "the pose is not a position and a rotation";
  }
  return std::nullopt;
}

std::vector<float> DisparitiesOf(const DepthImage& depth, const StereoGeometry& rig) {
  std::vector<float> disparities;
  disparities.reserve(depth.depths.size());
  const auto scale = static_cast<float>(rig.camera.fx * rig.baseline);
  for (const float z : depth.depths) {
    const bool measured = std::isfinite(z) && z > 0.0F;
    disparities.push_back(measured ? scale / z : std::numeric_limits<float>::quiet_NaN());
  }
  return disparities;
}

}  // namespace thalweg::surface
