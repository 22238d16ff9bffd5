#pragma once

#include "common/geometry/rigid_transform.h"

namespace thalweg::controller::test {

inline RigidTransform At(double x, double y = 0.0, double z = 0.0, double yaw = 0.0, double pitch = 0.0) {
  return MakeTransform(RotationFromYawPitch(yaw, pitch), {x, y, z});
}

/// A place on the x axis.
inline RigidTransform OnAxis(double x, double yaw = 0.0) {
  return At(x, 0.0, 0.0, yaw);
}

}  // namespace thalweg::controller::test
