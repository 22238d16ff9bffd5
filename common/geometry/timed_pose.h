#pragma once

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg {

/// A pose at a moment; whose it is and in which frame, who holds it says.
struct TimedPose {
  Time stamp;
  RigidTransform T;
};

}  // namespace thalweg
