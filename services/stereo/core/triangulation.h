#pragma once

#include "common/geometry/point_cloud.h"
#include "common/geometry/stereo_geometry.h"
#include "services/stereo/core/image.h"

namespace thalweg::stereo {

struct TriangulationOptions {
  double min_depth = 0.2;        ///< [m] Nearer points are dropped.
  double max_depth = 100.0;      ///< [m] Farther points are dropped.
  double disparity_error = 0.3;  ///< [px] Assumed standard deviation of disparities.
  double max_depth_error =
      0.25;  ///< [m] Points with a larger standard deviation, z^2 / (f b) times disparity_error, are dropped.
};

/// [m] The largest depth that the options admit.
double FarthestDepth(const StereoGeometry& camera, const TriangulationOptions& options);

/// Triangulates every pixel, z = f b / d; NaN where there is no disparity or the options drop the point.
/// @param image  The left image, for the colors; may be gray.
PointCloud Triangulate(const DisparityMap& disparity, const ByteImage& image, const StereoGeometry& camera,
                       const TriangulationOptions& options);

}  // namespace thalweg::stereo
