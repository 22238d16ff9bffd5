#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

namespace thalweg {

/// An ideal pinhole camera. Pixel (u, v) is (right, down); integers are pixel centers. A point (x, y, z) in C
/// projects to u = fx x / z + cx, v = fy y / z + cy.
struct PinholeCamera {
  int width_px = 0;
  int height_px = 0;
  double fx = 0.0;  ///< [px]
  double fy = 0.0;  ///< [px]
  double cx = 0.0;  ///< [px]
  double cy = 0.0;  ///< [px]

  /// Makes a camera with square pixels and the principal point at the image center.
  /// @param horizontal_fov  [rad] From the outer edge of the first pixel to that of the last.
  static PinholeCamera FromFieldOfView(int width_px, int height_px, double horizontal_fov) {
    const double f = 0.5 * width_px / std::tan(0.5 * horizontal_fov);
    return {width_px, height_px, f, f, 0.5 * (width_px - 1), 0.5 * (height_px - 1)};
  }

  /// The point in C at depth 1 that pixel (u, v) sees.
  Eigen::Vector3d RayAtUnitDepth(double u, double v) const { return {(u - cx) / fx, (v - cy) / fy, 1.0}; }

  /// Projects a point in C to (u, v) [px]; nothing if it lies behind the camera or outside the image.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& p_C) const {
    if (p_C.z() <= 0.0) return std::nullopt;
    const double u = fx * p_C.x() / p_C.z() + cx;
    const double v = fy * p_C.y() / p_C.z() + cy;
    if (!(u >= -0.5 && v >= -0.5 && u < width_px - 0.5 && v < height_px - 0.5)) return std::nullopt;
    return Eigen::Vector2d(u, v);
  }
  bool Sees(const Eigen::Vector3d& p_C) const { return Project(p_C).has_value(); }
};

}  // namespace thalweg
