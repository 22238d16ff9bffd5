#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace thalweg {

struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  bool operator==(const Rgb&) const = default;
};

/// An organised cloud: one point a pixel, row-major, in the camera frame C.
struct PointCloud {
  int width_px = 0;
  int height_px = 0;
  std::vector<Eigen::Vector3f> points_C;  ///< [m] width * height; a point with any NaN = no measurement.
  std::vector<Rgb> colors;                ///< width * height, or empty when the sensor has none.
};

}  // namespace thalweg
