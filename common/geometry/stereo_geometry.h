#pragma once

#include "common/geometry/pinhole_camera.h"

namespace thalweg {

/// Two identical rectified cameras, the right one at `baseline` along the left one's x axis. A point at depth
/// z appears fx * baseline / z pixels farther left in the right image.
struct StereoGeometry {
  PinholeCamera camera;   ///< Either camera.
  double baseline = 0.0;  ///< [m] > 0
};

}  // namespace thalweg
