#pragma once

#include <random>

#include "common/geometry/point_cloud.h"
#include "common/geometry/robot_model.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// A depth camera that casts one ray through each pixel's center.
///
/// Noise, if enabled, is Gaussian in the disparity d = fx b / z that a stereo pair with baseline b would
/// measure. The point is triangulated from the noisy disparity, so the depth error is skewed and grows with
/// z^2. A pixel whose noisy disparity is not positive has no measurement.
class DepthSensor {
 public:
  /// @param colors  Whether clouds have colors; computing them costs as much as casting the rays.
  explicit DepthSensor(const DepthSensorModel& model, std::uint32_t noise_seed = 1, bool colors = true);

  /// @return Organized cloud in C. Where the ray meets no surface within max_range of its start, the point is
  /// NaN, or NoReturn() for a sensor whose missing returns mean free space.
  PointCloud Capture(const World& world, const RigidTransform& T_WC);

 private:
  DepthSensorModel model_;
  std::mt19937 random_;
  bool colors_;
};

}  // namespace thalweg::simulator
