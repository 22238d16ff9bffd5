#pragma once

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg {

/// A pose at a point in time; the context defines the body and the frame.
struct TimedPose {
  Time stamp;
  RigidTransform T;
};

}  // namespace thalweg
