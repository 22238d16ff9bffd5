#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

namespace thalweg {

struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  bool operator==(const Rgb&) const = default;
};

/// An organized point cloud: one point per pixel, row-major, in the camera frame C.
struct PointCloud {
  int width_px = 0;
  int height_px = 0;
  /// [m] width * height points; any NaN = not measured, z = +infinity = IsNoReturn.
  std::vector<Eigen::Vector3f> points_C;
  std::vector<Rgb> colors;  ///< width * height colors, or empty if the sensor has none.
};

/// A pixel whose ray met nothing within the sensor's range, as distinct from a pixel that was not measured
/// [REP 117: Informational Distance Measurements, ROS]. Only some sensors can distinguish the two: a lidar or
/// a time-of-flight camera can, a stereo camera cannot.
inline Eigen::Vector3f NoReturn() {
  return {0.0F, 0.0F, std::numeric_limits<float>::infinity()};
}
inline bool IsNoReturn(const Eigen::Vector3f& p_C) {
  return p_C.z() == std::numeric_limits<float>::infinity();
}

}  // namespace thalweg
