#pragma once

#include "common/scenario/scenario.h"
#include "services/simulator/core/stereo_rig.h"

namespace thalweg::simulator {

/// A scenario's stereo camera, whether it is enabled or not.
StereoRigModel StereoRigFrom(const Scenario& scenario);

}  // namespace thalweg::simulator
