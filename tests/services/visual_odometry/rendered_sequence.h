#pragma once

#include <optional>
#include <vector>

#include "common/geometry/stereo_geometry.h"
#include "services/simulator/core/stereo_rig.h"
#include "services/visual_odometry/core/frame.h"

namespace thalweg::visual_odometry::test {

/// A way through a world, as the poses of the camera at the frames.
struct Flight {
  double rate = 20.0;  ///< [Hz]
  std::vector<RigidTransform> T_WCs;

  double Length() const;  ///< [m]
  Time StampOf(std::size_t frame) const;
};

enum class Motion {
  kSmooth,  ///< Constant speed, looking where it goes, swaying a little.
  kJerky,   ///< Stops and goes, with shakes of up to 1 rad/s about all axes.
};

/// Rounds on the largest upright ellipse that keeps clear of all surfaces, at about 0.5 m/s, until the way is
/// `length` [m] long. Throws std::runtime_error when none fits.
Flight FlyRounds(const simulator::World& world, Motion motion, double length);

/// 512 x 384, 66 degrees, 0.12 m, with noise of two grey values.
simulator::StereoRigModel NoisyRig();
StereoGeometry GeometryOf(const simulator::StereoRigModel& model);

StereoImages Render(simulator::StereoRig& rig, const simulator::World& world, const Flight& flight,
                    std::size_t frame);

}  // namespace thalweg::visual_odometry::test
