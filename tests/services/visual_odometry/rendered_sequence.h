#pragma once

#include <optional>
#include <vector>

#include "common/geometry/stereo_geometry.h"
#include "services/simulator/core/stereo_rig.h"
#include "services/visual_odometry/core/frame.h"

namespace thalweg::visual_odometry::test {

/// A path through a world, as the camera's pose at each frame.
struct Flight {
  double rate = 20.0;  ///< [Hz]
  std::vector<RigidTransform> T_WCs;

  double Length() const;  ///< [m]
  Time StampOf(std::size_t frame) const;
};

enum class Motion {
  kSmooth,  ///< Constant speed, looking ahead, swaying slightly.
  kJerky,   ///< Stop and go, with shakes of up to 1 rad/s about all axes.
};

/// Rounds on the largest upright ellipse that keeps clear of all surfaces, at about 0.5 m/s, until the path
/// is `length` [m] long. Throws std::runtime_error if none fits.
Flight FlyRounds(const simulator::World& world, Motion motion, double length);

/// 512 x 384, 66 degrees, 0.12 m baseline, with noise of two gray values.
simulator::StereoRigModel NoisyRig();
StereoGeometry GeometryOf(const simulator::StereoRigModel& model);

StereoImages Render(simulator::StereoRig& rig, const simulator::World& world, const Flight& flight,
                    std::size_t frame);

}  // namespace thalweg::visual_odometry::test
