#include "services/simulator/adapter/stereo_camera.h"

#include "common/scenario/models.h"
#include "common/scenario/option_binding.h"

namespace thalweg::simulator {

void Visit(OptionVisitor& visitor, StereoRigModel& rig) {
  Visit(visitor, rig.camera);
  visitor.Number("baseline_m", rig.baseline);
  visitor.Number("rate_hz", rig.rate);
  visitor.Number("noise_sigma", rig.noise_sigma);
}

StereoRigModel StereoRigFrom(const Scenario& scenario) {
  return ReadOptions<StereoRigModel>(scenario.stereo_camera());
}

}  // namespace thalweg::simulator
