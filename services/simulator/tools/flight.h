#pragma once

#include <vector>

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"
#include "services/simulator/core/stereo_rig.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// A path through a world, as the poses of the camera at the frames.
struct Flight {
  double rate = 20.0;  ///< [Hz]
  std::vector<RigidTransform> T_WCs;

  double Length() const;  ///< [m]
  Time StampOf(std::size_t frame) const;
};

enum class Motion {
  kSmooth,  ///< Constant speed, looking ahead, swaying a little.
  kJerky,   ///< Stops and goes, with shakes of up to 1 rad/s about all axes.
};

/// Rounds on the largest upright ellipse that keeps clear of all surfaces, at about 0.5 m/s, until the path
/// is `length` [m] long. Throws std::runtime_error when none fits.
Flight FlyRounds(const World& world, Motion motion, double length);

/// 512 x 384, 66 degrees, 0.12 m, with noise of two gray values.
StereoRigModel NoisyRig();

}  // namespace thalweg::simulator
