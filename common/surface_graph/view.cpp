#include "common/surface_graph/view.h"

#include <limits>

#include "common/base/size_text.h"
#include "common/base/text.h"
#include "common/geometry/plausible.h"

namespace thalweg::surface {

std::optional<std::string> MistakeIn(const View& view) {
  const PinholeCamera& camera = view.rig.camera;
  if (std::optional<std::string> mistake = MistakeIn(camera)) return mistake;
  if (!(view.rig.baseline > 0.0 && view.rig.baseline <= kFarthest)) {
    return "the baseline is " + NumberText(view.rig.baseline) + " m, must be above 0 and at most 1000 km";
  }
  const auto pixels = static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
  const std::string size = SizeText(camera.width_px, camera.height_px);
  if (view.disparities.size() != pixels) {
    return std::to_string(view.disparities.size()) + " disparities for a camera of " + size;
  }
  if (!view.colors.empty() && view.colors.size() != pixels) {
    return std::to_string(view.colors.size()) + " colors for a camera of " + size;
  }
  if (!IsPose(view.T_WC)) return "the pose is not a position and a rotation";
  return std::nullopt;
}

bool View::HasMeasurement() const {
  for (std::size_t pixel = 0; pixel < disparities.size(); ++pixel) {
    if (IsValid(pixel)) return true;
  }
  return false;
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
