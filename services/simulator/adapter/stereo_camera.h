#pragma once

#include "common/scenario/scenario.h"
#include "services/simulator/core/stereo_rig.h"

namespace thalweg::simulator {

/// Converts a scenario's stereo camera, whether or not it is enabled.
StereoRigModel StereoRigFrom(const Scenario& scenario);

}  // namespace thalweg::simulator
