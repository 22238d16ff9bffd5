#pragma once

#include <limits>

#include "common/geometry/point_cloud.h"
#include "common/geometry/rigid_transform.h"

/// Clouds that tests write down pixel by pixel, and a camera that takes them.
namespace thalweg::test {

inline constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A cloud of one pixel, `depth` straight ahead.
inline PointCloud SinglePoint(float depth) {
  return {.width_px = 1, .height_px = 1, .points_C = {{0.0F, 0.0F, depth}}, .colors = {}};
}

/// A camera at (0.03, 0.04, 0.05) that looks along x, turned by `yaw`.
inline RigidTransform LevelPose(double yaw = 0.0) {
  return MakeTransform(RotationFromYawPitch(yaw, 0.0) * BodyFromOptical(), {0.03, 0.04, 0.05});
}

}  // namespace thalweg::test
