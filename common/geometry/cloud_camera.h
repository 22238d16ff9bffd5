#pragma once

#include <optional>

#include "common/base/result.h"
#include "common/geometry/pinhole_camera.h"
#include "common/geometry/point_cloud.h"

namespace thalweg {

/// The camera that an organized cloud was taken with, from its points alone: a point (x, y, z) of pixel (u,
/// v) has u = fx x / z + cx and v = fy y / z + cy, whatever the error of its depth; two straight lines,
/// fitted by least squares. Nothing, if the points span too little of the image.
///
/// Error, if the cloud is not organized, or if its points are not those of one pinhole camera: if one of them
/// is not where its pixel is.
Result<std::optional<PinholeCamera>> CameraOf(const PointCloud& cloud);

/// Whether a cloud has the camera's size, and all of its points, if any, are where their pixels are.
bool Fits(const PinholeCamera& camera, const PointCloud& cloud);

/// What the camera looks at, in C: of the points within `max_range` [m] the one whose pixel is nearest to the
/// principal point; the first in the image of several.
std::optional<Eigen::Vector3f> PointLookedAt(const PointCloud& cloud, const PinholeCamera& camera,
                                             double max_range);

/// Whether both have the same size, and every pixel the same ray, within a pixel.
bool IsSameCamera(const PinholeCamera& a, const PinholeCamera& b);

/// The camera of a row of clouds. One that suddenly is another is not believed, until it has stayed.
class SteadyCamera {
 public:
  static constexpr int kToStay = 10;  ///< Clouds in a row.

  const std::optional<PinholeCamera>& camera() const { return camera_; }
  /// @param camera  Camera of the next cloud. @return Whether it is to be used.
  bool Accepts(const PinholeCamera& camera);

 private:
  std::optional<PinholeCamera> camera_;
  std::optional<PinholeCamera> other_;  ///< The one that was not believed last,
  int in_a_row_ = 0;                    ///< so many times in a row.
};

}  // namespace thalweg
