#include "services/evaluator/adapter/stereo_options.h"

#include <algorithm>

#include "services/simulator/adapter/stereo_camera.h"
#include "services/stereo/adapter/options.h"

namespace thalweg::evaluator {

StereoSensor::Options StereoSensorFrom(const Scenario& scenario) {
  const stereo::StereoOptions options = stereo::OptionsFrom(scenario);
  StereoSensor::Options sensor{.rig = simulator::StereoRigFrom(scenario),
                               .engine = options.engine,
                               .matcher = options.matcher,
                               .refine = options.refine,
                               .refinement = options.refinement,
                               .triangulation = options.triangulation};
  if (options.rate > 0.0) sensor.rate = std::min(sensor.rate, options.rate);
  sensor.matcher.threads = 1;  // since runs share the cores
  return sensor;
}

}  // namespace thalweg::evaluator
