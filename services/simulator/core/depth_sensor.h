#pragma once

#include <random>

#include "common/geometry/point_cloud.h"
#include "common/geometry/robot_model.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// A depth camera: one ray a pixel, through the pixel's centre.
///
/// Noise, when asked for, is Gaussian on the disparity d = fx b / z that a stereo pair of that baseline would
/// measure; the point is then triangulated from the noisy disparity, so that errors in depth are skewed and
/// grow with z^2. A pixel whose noisy disparity is not positive has no measurement.
class DepthSensor {
 public:
  /// @param colors  Whether clouds have colours; they cost as much as the rays.
  explicit DepthSensor(const DepthSensorModel& model, std::uint32_t noise_seed = 1, bool colors = true);

  /// @return organised cloud in C; NaN, or NoReturn() of a sensor whose no return is free, where no surface
  /// lies within max_range of the ray's start.
  PointCloud Capture(const World& world, const RigidTransform& T_WC);

 private:
  DepthSensorModel model_;
  std::mt19937 random_;
  bool colors_;
};

}  // namespace thalweg::simulator
