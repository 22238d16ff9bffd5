#include "services/simulator/adapter/stereo_camera.h"

#include <cmath>

#include "common/geometry/angles.h"

namespace thalweg::simulator {

StereoRigModel StereoRigFrom(const Scenario& scenario) {
  const StereoCamera& camera = scenario.stereo_camera();
  StereoRigModel model;
  const PinholeCamera& normal = model.camera;
  const double normal_fov = 2.0 * std::atan(0.5 * normal.width_px / normal.fx);
  model.camera = PinholeCamera::FromFieldOfView(
      camera.has_width_px() ? camera.width_px() : normal.width_px,
      camera.has_height_px() ? camera.height_px() : normal.height_px,
      camera.has_horizontal_fov_deg() ? camera.horizontal_fov_deg() * kDegree : normal_fov);
  if (camera.has_baseline_m()) model.baseline = camera.baseline_m();
  if (camera.has_rate_hz()) model.rate = camera.rate_hz();
  if (camera.has_noise_sigma()) model.noise_sigma = camera.noise_sigma();
  return model;
}

}  // namespace thalweg::simulator
