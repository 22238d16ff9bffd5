#pragma once

#include "common/geometry/point_cloud.h"
#include "common/geometry/stereo_geometry.h"
#include "services/stereo/core/image.h"

namespace thalweg::stereo {

struct TriangulationOptions {
  double min_depth = 0.2;        ///< [m] Nearer points are none.
  double max_depth = 100.0;      ///< [m] Farther points are none.
  double disparity_error = 0.3;  ///< [px] Standard deviation that depth errors are reckoned with.
  double max_depth_error =
      0.25;  ///< [m] Points whose standard deviation z^2 / (f b) times it is larger are none.
};

/// The farthest depth that the options leave [m].
double FarthestDepth(const StereoGeometry& camera, const TriangulationOptions& options);

/// z = f b / d, for every pixel; NaN where there is no disparity or none that the options leave.
/// @param image  The left one, for the colours; grey becomes grey colours.
PointCloud Triangulate(const DisparityMap& disparity, const ByteImage& image, const StereoGeometry& camera,
                       const TriangulationOptions& options);

}  // namespace thalweg::stereo
