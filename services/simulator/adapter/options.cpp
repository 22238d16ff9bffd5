#include "services/simulator/adapter/options.h"

#include <stdexcept>

#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/adapter/stereo_camera.h"

namespace thalweg::simulator {

SimulatorOptions OptionsFrom(const Scenario& scenario, const World& world) {
  SimulatorOptions options;
  options.robot = RobotFrom(scenario);
  options.T_WB_start = StartFrom(scenario, world, options.robot);
  options.depth_sensor = DepthSensorFrom(scenario);
  if (scenario.depth_sensor().has_enabled()) options.depth_enabled = scenario.depth_sensor().enabled();
  if (scenario.stereo_camera().enabled()) options.stereo_camera = StereoRigFrom(scenario);
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
