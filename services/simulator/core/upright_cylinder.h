#pragma once

#include "common/geometry/triangle.h"

namespace thalweg::simulator {

/// A solid cylinder with a vertical axis: the body of a robot that has a height.
///
/// The distance of a point p is defined as max(h - radius, v - height / 2), where h is the horizontal
/// distance of p from the axis and v its vertical distance from the center. It is negative inside and changes
/// by no more than the cylinder moves. The points within distance k fill the same cylinder grown by k on all
/// sides.
struct UprightCylinder {
  Eigen::Vector3d center;
  double radius = 0.0;  ///< [m]
  double height = 0.0;  ///< [m]
};

/// [m] Distance to the nearest point of the triangle, or to the deepest one inside; too small by at most 0.1
/// um. Returns `limit` when the distance is not less than that.
double Distance(const UprightCylinder& cylinder, const Triangle& triangle, double limit);

/// [m] Distance to the nearest point of a solid box; negative when the two overlap.
double Distance(const UprightCylinder& cylinder, const Eigen::AlignedBox3d& box);

}  // namespace thalweg::simulator
