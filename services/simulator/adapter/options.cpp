#include "services/simulator/adapter/options.h"

#include <numbers>
#include <stdexcept>

#include "services/simulator/adapter/load_mesh.h"

namespace thalweg::simulator {
namespace {

std::optional<StereoRigModel> StereoFrom(const StereoCamera& camera) {
  if (!camera.enabled()) return std::nullopt;
  StereoRigModel model;
  const PinholeCamera& normal = model.camera;
  const double normal_fov = 2.0 * std::atan(0.5 * normal.width_px / normal.fx);
  model.camera = PinholeCamera::FromFieldOfView(
      camera.has_width_px() ? camera.width_px() : normal.width_px,
      camera.has_height_px() ? camera.height_px() : normal.height_px,
      camera.has_horizontal_fov_deg() ? camera.horizontal_fov_deg() * std::numbers::pi / 180.0 : normal_fov);
  if (camera.has_baseline_m()) model.baseline = camera.baseline_m();
  if (camera.has_rate_hz()) model.rate = camera.rate_hz();
  if (camera.has_noise_sigma()) model.noise_sigma = camera.noise_sigma();
  return model;
}

}  // namespace

SimulatorOptions OptionsFrom(const Scenario& scenario, const World& world) {
  SimulatorOptions options;
  options.robot = RobotFrom(scenario);
  options.T_WB_start = StartFrom(scenario, world, options.robot);
  options.depth_sensor = DepthSensorFrom(scenario);
  if (scenario.depth_sensor().has_enabled()) options.depth_enabled = scenario.depth_sensor().enabled();
  options.stereo_camera = StereoFrom(scenario.stereo_camera());
  const thalweg::Simulator& simulator = scenario.simulator();
  if (simulator.has_time_scale()) options.time_scale = simulator.time_scale();
  if (simulator.has_odometry_rate_hz()) options.odometry_rate = simulator.odometry_rate_hz();
  options.is_odometry = !scenario.has_visual_odometry();
  const bool wants_images = scenario.has_visual_odometry() &&
                            scenario.visual_odometry().source() == thalweg::VisualOdometry::STEREO;
  if (wants_images && !options.stereo_camera) {
    throw std::invalid_argument("visual_odometry.source = STEREO needs stereo_camera.enabled = true");
  }
  if (simulator.has_noise_seed()) options.noise_seed = static_cast<std::uint32_t>(simulator.noise_seed());
  return options;
}

}  // namespace thalweg::simulator
