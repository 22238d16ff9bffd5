#include "services/simulator/core/upright_cylinder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "common/geometry/interval.h"

namespace thalweg::simulator {
namespace {

constexpr double kResolution = 1e-7;  // [m]
constexpr double kRounding = 1e-9;    // [m]
// [m^2] The polygon is seen edge-on; its edges alone determine the distance.
constexpr double kNoArea = 1e-12;

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// [m] Horizontal distance from a convex polygon to the cylinder's axis; 0 when the axis passes through it.
double DistanceToAxis(std::span<const Eigen::Vector3d> polygon, const Eigen::Vector3d& center) {
  double nearest = std::numeric_limits<double>::infinity();
  double least_turn = std::numeric_limits<double>::infinity();
  double greatest_turn = -std::numeric_limits<double>::infinity();
  double area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d from = (polygon[i] - center).head<2>();
    const Eigen::Vector2d edge = (polygon[(i + 1) % polygon.size()] - center).head<2>() - from;
    const double squared = edge.squaredNorm();
    const double share = squared > 0.0 ? std::clamp(-from.dot(edge) / squared, 0.0, 1.0) : 0.0;
    nearest = std::min(nearest, (from + share * edge).norm());
    const double turn = Cross(from, edge);
    least_turn = std::min(least_turn, turn);
    greatest_turn = std::max(greatest_turn, turn);
    area += 0.5 * turn;
  }
  const bool inside = std::abs(area) > kNoArea && (least_turn >= 0.0 || greatest_turn <= 0.0);
  return inside ? 0.0 : nearest;
}

/// Whether any part of the triangle is within distance k of the cylinder.
bool IsWithin(const UprightCylinder& cylinder, const Triangle& triangle, double k) {
  const double reach = 0.5 * cylinder.height + k;
  const double middle = cylinder.center.z();
  const std::vector<Eigen::Vector3d> polygon = ClipToSlab(triangle, 2, middle - reach, middle + reach);
  return !polygon.empty() && DistanceToAxis(polygon, cylinder.center) <= cylinder.radius + k;
}

}  // namespace

double Distance(const UprightCylinder& cylinder, const Triangle& triangle, double limit) {
  const auto [low, high] = std::minmax({triangle[0].z(), triangle[1].z(), triangle[2].z()});
  const double above = DistanceToInterval(cylinder.center.z(), low, high) - 0.5 * cylinder.height;
  if (above >= limit) return limit;
  const double beside = DistanceToAxis(triangle, cylinder.center) - cylinder.radius;
  double least = std::max(above, beside);
  if (least >= limit) return limit;
  // Usually one of the two decides, e.g. for a wall or a floor. Otherwise the triangle comes near the axis at
  // one point and near the height at another; bisection finds the smallest k at which one point satisfies
  // both.
  if (IsWithin(cylinder, triangle, least + kRounding)) return least;
  if (!IsWithin(cylinder, triangle, limit)) return limit;
  for (double most = limit; most - least > kResolution;) {
    const double k = 0.5 * (least + most);
    (IsWithin(cylinder, triangle, k) ? most : least) = k;
  }
  return least;
}

double Distance(const UprightCylinder& cylinder, const Eigen::AlignedBox3d& box) {
  const Eigen::Vector3d nearest = cylinder.center.cwiseMax(box.min()).cwiseMin(box.max());
  const Eigen::Vector3d offset = nearest - cylinder.center;
  return std::max(offset.head<2>().norm() - cylinder.radius, std::abs(offset.z()) - 0.5 * cylinder.height);
}

}  // namespace thalweg::simulator
