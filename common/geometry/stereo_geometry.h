#pragma once

#include "common/geometry/pinhole_camera.h"

namespace thalweg {

/// Two equal, rectified cameras: the right one lies `baseline` along the left one's x axis. A point at depth
/// z falls fx * baseline / z pixels further left in the right image.
struct StereoGeometry {
  PinholeCamera camera;   ///< Either of them.
  double baseline = 0.0;  ///< [m] > 0
};

}  // namespace thalweg
