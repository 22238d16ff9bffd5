#pragma once

#include <limits>
#include <vector>

#include "common/geometry/pinhole_camera.h"
#include "common/geometry/point_cloud.h"

namespace thalweg {

/// Depths along the optical axis, one per pixel, row-major.
struct DepthImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<float> depths;  ///< [m] NaN = not measured, +infinity = nothing in range.
};

/// The points that the pixels see.
/// @param camera  Has the image's size.
inline PointCloud CloudFrom(const DepthImage& image, const PinholeCamera& camera) {
  PointCloud cloud{.width_px = image.width_px, .height_px = image.height_px, .points_C = {}, .colors = {}};
  cloud.points_C.reserve(image.depths.size());
  auto depth = image.depths.begin();
  for (int v = 0; v < image.height_px; ++v) {
    for (int u = 0; u < image.width_px; ++u, ++depth) {
      const bool no_return = *depth == std::numeric_limits<float>::infinity();
      const Eigen::Vector3f ray_C = camera.RayAtUnitDepth(u, v).cast<float>();
      cloud.points_C.push_back(no_return ? NoReturn() : Eigen::Vector3f(*depth * ray_C));
    }
  }
  return cloud;
}

}  // namespace thalweg
