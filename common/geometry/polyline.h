#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

namespace thalweg {

/// Smallest number of equal pieces, each no longer than `step`, that `length` divides into; at least 1.
inline int PiecesOf(double length, double step) {
  return std::max(1, static_cast<int>(std::ceil(length / step)));
}

/// Visits the points that divide the segment from a to b into the fewest equal pieces no longer than `step`,
/// excluding a and including b. Stops when the visitor returns false.
/// @param visit  bool(const Eigen::Vector3d& point)
/// @return Whether all points were visited.
template <class Visit>
bool ForEachPointAlong(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double step, Visit&& visit) {
  const Eigen::Vector3d along = b - a;
  const int pieces = PiecesOf(along.norm(), step);
  for (int piece = 1; piece <= pieces; ++piece) {
    if (!visit(Eigen::Vector3d(a + along * (static_cast<double>(piece) / pieces)))) return false;
  }
  return true;
}

/// The point of segment a-b nearest to p, as a share of the segment; 0 if the segment is a point.
inline double NearestShare(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& p) {
  const double squared = (b - a).squaredNorm();
  return squared > 0.0 ? std::clamp((p - a).dot(b - a) / squared, 0.0, 1.0) : 0.0;
}

/// Distance from p to segment a-b.
inline double DistanceToSegment(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                const Eigen::Vector3d& p) {
  return (a + NearestShare(a, b, p) * (b - a) - p).norm();
}

/// Length of the polyline through the points; 0 for fewer than two.
inline double PathLength(const std::vector<Eigen::Vector3d>& points) {
  double length = 0.0;
  for (std::size_t n = 1; n < points.size(); ++n) length += (points[n] - points[n - 1]).norm();
  return length;
}

/// The same for poses, or anything with a translation().
template <class Pose>
double PathLength(const std::vector<Pose>& poses) {
  double length = 0.0;
  for (std::size_t n = 1; n < poses.size(); ++n) {
    length += (poses[n].translation() - poses[n - 1].translation()).norm();
  }
  return length;
}

}  // namespace thalweg
