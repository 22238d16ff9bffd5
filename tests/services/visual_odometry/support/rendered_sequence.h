#pragma once

#include "common/geometry/stereo_geometry.h"
#include "services/simulator/tools/flight.h"
#include "services/visual_odometry/core/frame.h"

namespace thalweg::visual_odometry::test {

using simulator::Flight;
using simulator::FlyRounds;
using simulator::Motion;
using simulator::NoisyRig;

StereoGeometry GeometryOf(const simulator::StereoRigModel& model);

StereoImages Render(simulator::StereoRig& rig, const simulator::World& world, const Flight& flight,
                    std::size_t frame);

}  // namespace thalweg::visual_odometry::test
