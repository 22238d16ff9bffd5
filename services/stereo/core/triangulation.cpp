#include "services/stereo/core/triangulation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/check.h"

namespace thalweg::stereo {

double FarthestDepth(const StereoGeometry& camera, const TriangulationOptions& options) {
  const double scale = camera.camera.fx * camera.baseline;
  return std::min(options.max_depth, std::sqrt(options.max_depth_error * scale / options.disparity_error));
}

PointCloud Triangulate(const DisparityMap& disparity, const ByteImage& image, const StereoGeometry& camera,
                       const TriangulationOptions& options) {
  THALWEG_CHECK(disparity.SameSizeAs(image));
  const auto scale = static_cast<float>(camera.camera.fx * camera.baseline);
  const auto nearest = static_cast<float>(options.min_depth);
  const auto farthest = static_cast<float>(FarthestDepth(camera, options));
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  PointCloud cloud;
  cloud.width_px = disparity.width();
  cloud.height_px = disparity.height();
  cloud.points_C.reserve(disparity.data().size());
  cloud.colors.reserve(disparity.data().size());
  for (int v = 0; v < disparity.height(); ++v) {
    for (int u = 0; u < disparity.width(); ++u) {
      const float z = scale / disparity(u, v);
      const bool good = z >= nearest && z <= farthest;  // not for NaN
      cloud.points_C.emplace_back(good ? Eigen::Vector3f(camera.camera.RayAtUnitDepth(u, v).cast<float>() * z)
                                       : Eigen::Vector3f(kNone, kNone, kNone));
      const std::uint8_t* const pixel = &image(u, v);
      cloud.colors.push_back(image.channels() == 3 ? Rgb{pixel[0], pixel[1], pixel[2]}
                                                   : Rgb{pixel[0], pixel[0], pixel[0]});
    }
  }
  return cloud;
}

}  // namespace thalweg::stereo
