#pragma once

#include <random>

#include "common/geometry/point_cloud.h"
#include "common/geometry/robot_model.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// A depth camera that casts one ray through each pixel's center.
///
/// Noise, if enabled, is that of a stereo pair with baseline b, from which the point is triangulated: Gaussian
/// in the disparity d = fx b / z, and in the position in the left image, both coordinates alike [Shade: Choosing
/// Where To Go, DPhil thesis, Oxford 2011, 6.5.3], which moves the disparity by as much as the column. So the
/// depth error is skewed and grows with z^2. A pixel whose noisy disparity is not positive has no measurement.
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
