#pragma once

#include "common/base/option_visitor.h"
#include "common/scenario/scenario.h"
#include "services/simulator/core/stereo_rig.h"

namespace thalweg::simulator {

void Visit(OptionVisitor& visitor, StereoRigModel& rig);  ///< Block `stereo_camera`, but for `enabled`.

/// Converts a scenario's stereo camera, whether or not it is enabled.
StereoRigModel StereoRigFrom(const Scenario& scenario);

}  // namespace thalweg::simulator
