#pragma once

#include "services/simulator/core/triangle.h"

namespace thalweg::simulator {

/// Its distance from a point p is max(h - radius, v - height / 2), h and v being how far p lies beside its
/// axis and above or below its middle: negative inside, and changing by no more than the cylinder moves. What
/// is within distance k is the cylinder that is larger by k on all sides.
struct UprightCylinder {
  Eigen::Vector3d center;
  double radius = 0.0;  ///< [m]
  double height = 0.0;  ///< [m]
};

/// [m] To the triangle's nearest point, or the deepest one inside; at most 0.1 um too little.
/// `limit` when it is not less than that.
double Distance(const UprightCylinder& cylinder, const Triangle& triangle, double limit);

/// [m] To the nearest point of a solid box; negative when they share space.
double Distance(const UprightCylinder& cylinder, const Eigen::AlignedBox3d& box);

}  // namespace thalweg::simulator
