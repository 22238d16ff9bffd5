#include "services/simulator/adapter/options.h"

#include "common/scenario/models.h"
#include "common/scenario/option_binding.h"
#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/adapter/stereo_camera.h"

namespace thalweg::simulator {

void Visit(OptionVisitor& visitor, SimulatorOptions& options) {
  visitor.Number("time_scale", options.time_scale);
  visitor.Number("odometry_rate_hz", options.odometry_rate);
  visitor.Whole("noise_seed", options.noise_seed);
}

SimulatorOptions OptionsFrom(const Scenario& scenario, const World& world) {
  SimulatorOptions options;
  ReadOptions(scenario.simulator(), options);
  options.robot = RobotFrom(scenario);
  options.T_WB_start = StartFrom(scenario, world, options.robot);
  options.depth_sensor = DepthSensorFrom(scenario);
  options.depth_enabled = scenario.depth_source() == DepthSource::DEPTH_SENSOR;
  if (scenario.stereo_camera().enabled()) options.stereo_camera = StereoRigFrom(scenario);
  options.is_odometry = scenario.odometry_source() == OdometrySource::SIMULATOR;
  return options;
}

}  // namespace thalweg::simulator
