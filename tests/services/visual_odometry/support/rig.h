#pragma once

#include "common/geometry/stereo_geometry.h"

namespace thalweg::visual_odometry::test {

/// 512 x 384, 66 degrees, 0.12 m baseline.
inline const StereoGeometry kRig{PinholeCamera::FromFieldOfView(512, 384, 1.15), 0.12};

}  // namespace thalweg::visual_odometry::test
