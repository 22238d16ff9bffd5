#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

namespace thalweg {

/// Into how many equal pieces no longer than `step` a length is divided at least; 1 for no length.
inline int PiecesOf(double length, double step) {
  return std::max(1, static_cast<int>(std::ceil(length / step)));
}

/// Visits the points that divide the segment from a to b into the fewest equal pieces no longer than `step`:
/// b is the last, a is left out. Ends early when the visitor returns false. @return whether all points were
/// visited.
/// @param visit  bool(const Eigen::Vector3d& point)
template <class Visit>
bool ForEachPointAlong(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double step, Visit&& visit) {
  const Eigen::Vector3d along = b - a;
  const int pieces = PiecesOf(along.norm(), step);
  for (int piece = 1; piece <= pieces; ++piece) {
    if (!visit(Eigen::Vector3d(a + along * (static_cast<double>(piece) / pieces)))) return false;
  }
  return true;
}

/// The length of a path through these points; 0 for fewer than two.
inline double PathLength(const std::vector<Eigen::Vector3d>& points) {
  double length = 0.0;
  for (std::size_t n = 1; n < points.size(); ++n) length += (points[n] - points[n - 1]).norm();
  return length;
}

/// The same for poses, anything that has a translation().
template <class Pose>
double PathLength(const std::vector<Pose>& poses) {
  double length = 0.0;
  for (std::size_t n = 1; n < poses.size(); ++n) {
    length += (poses[n].translation() - poses[n - 1].translation()).norm();
  }
  return length;
}

}  // namespace thalweg
