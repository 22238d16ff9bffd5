#include "common/geometry/triangle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/polyline.h"

namespace thalweg {
namespace {

struct Interval {
  double low;
  double high;
};

Interval Project(const Triangle& triangle, const Eigen::Vector3d& axis) {
  const double a = triangle[0].dot(axis);
  const double b = triangle[1].dot(axis);
  const double c = triangle[2].dot(axis);
  return {std::min({a, b, c}), std::max({a, b, c})};
}

/// Keeps the part of a polygon where side * (p[axis] - limit) <= 0.
void ClipToHalfSpace(std::vector<Eigen::Vector3d>& polygon, int axis, double limit, double side) {
  std::vector<Eigen::Vector3d> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d& a = polygon[i];
    const Eigen::Vector3d& b = polygon[(i + 1) % polygon.size()];
    const double above_a = side * (a[axis] - limit);
    const double above_b = side * (b[axis] - limit);
    if (above_a <= 0.0) kept.push_back(a);
    if ((above_a < 0.0 && above_b > 0.0) || (above_a > 0.0 && above_b < 0.0)) {
      kept.push_back(a + above_a / (above_a - above_b) * (b - a));
    }
  }
  polygon = std::move(kept);
}

void KeepSlab(std::vector<Eigen::Vector3d>& polygon, int axis, double low, double high) {
  ClipToHalfSpace(polygon, axis, high, 1.0);
  ClipToHalfSpace(polygon, axis, low, -1.0);
}

}  // namespace

double DistanceToTriangle(const Eigen::Vector3d& p, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  if (normal.squaredNorm() > 0.0) {
    const auto inside_of = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
      return (to - from).cross(p - from).dot(normal) >= 0.0;
    };
    if (inside_of(a, b) && inside_of(b, c) && inside_of(c, a)) {
      return std::abs((p - a).dot(normal)) / normal.norm();
    }
  }
  return std::min({DistanceToSegment(a, b, p), DistanceToSegment(b, c, p), DistanceToSegment(c, a, p)});
}

double OverlapDepth(const Triangle& triangle, const Eigen::AlignedBox3d& box) {
  const Eigen::Vector3d center = box.center();
  const Eigen::Vector3d half = 0.5 * box.sizes();
  const Triangle local = {triangle[0] - center, triangle[1] - center, triangle[2] - center};
  const std::array<Eigen::Vector3d, 3> edges = {local[1] - local[0], local[2] - local[1],
                                                local[0] - local[2]};
  double depth = std::numeric_limits<double>::infinity();
  const auto test = [&](const Eigen::Vector3d& axis) {
    const double length = axis.norm();
    if (length < 1e-12) return;  // the edges are parallel and yield no axis
    const Interval interval = Project(local, axis / length);
    const double reach = half.dot(axis.cwiseAbs()) / length;
    depth = std::min({depth, reach - interval.low, interval.high + reach});
  };
  for (int axis = 0; axis < 3; ++axis) test(Eigen::Vector3d::Unit(axis));
  if (depth < 0.0) return depth;
  test(edges[0].cross(edges[1]));
  for (int axis = 0; axis < 3; ++axis) {
    for (const Eigen::Vector3d& edge : edges) test(Eigen::Vector3d::Unit(axis).cross(edge));
  }
  return depth;
}

std::vector<Eigen::Vector3d> ClipToBox(const Triangle& triangle, const Eigen::AlignedBox3d& box) {
  std::vector<Eigen::Vector3d> polygon(triangle.begin(), triangle.end());
  for (int axis = 0; axis < 3; ++axis) KeepSlab(polygon, axis, box.min()[axis], box.max()[axis]);
  return polygon;
}

std::vector<Eigen::Vector3d> ClipToSlab(const Triangle& triangle, int axis, double low, double high) {
  std::vector<Eigen::Vector3d> polygon(triangle.begin(), triangle.end());
  KeepSlab(polygon, axis, low, high);
  return polygon;
}

}  // namespace thalweg
