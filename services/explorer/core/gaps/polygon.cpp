#include "services/explorer/core/gaps/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/base/check.h"

namespace thalweg::explorer {
namespace {

using Eigen::Vector2d;

/// Twice the area of a triangle: positive where c lies to the left of the line from a to b.
double Orientation(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return Cross(b - a, c - a);
}

double SignedArea(const std::vector<Vector2d>& vertices) {
  double twice = 0.0;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    twice += Cross(vertices[k], vertices[(k + 1) % vertices.size()]);
  }
  return twice / 2.0;
}

double DistanceToWall(const Vector2d& a, const Vector2d& b, const Vector2d& point) {
  const double share = std::clamp((point - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (a + share * (b - a) - point).norm();
}

bool Cross(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  return (Orientation(a, b, c) > 0.0) != (Orientation(a, b, d) > 0.0) &&
         (Orientation(c, d, a) > 0.0) != (Orientation(c, d, b) > 0.0);
}

/// Two walls without a common end touch where they cross or an end of one lies on the other.
bool Touch(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  return Cross(a, b, c, d) || DistanceToWall(a, b, c) == 0.0 || DistanceToWall(a, b, d) == 0.0 ||
         DistanceToWall(c, d, a) == 0.0 || DistanceToWall(c, d, b) == 0.0;
}

}  // namespace

Vector2d Turned(const Vector2d& direction, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {c * direction.x() - s * direction.y(), s * direction.x() + c * direction.y()};
}

Polygon::Polygon(std::vector<Vector2d> vertices) : vertices_(std::move(vertices)) {
  const std::size_t n = size();
  if (n < 3) throw std::invalid_argument("a polygon has at least three vertices");
  if (SignedArea(vertices_) <= 0.0)
    throw std::invalid_argument("the polygon's vertices are not counterclockwise");
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t m = k + 1; m < n; ++m) {
      if (Next(k) == m || Next(m) == k) continue;
      if (Touch(vertices_[k], vertices_[Next(k)], vertices_[m], vertices_[Next(m)])) {
        throw std::invalid_argument("walls " + std::to_string(k) + " and " + std::to_string(m) +
                                    " of the polygon touch");
      }
    }
  }
}

bool Polygon::IsReflex(std::size_t vertex) const {
  return Orientation(vertices_[Previous(vertex)], vertices_[vertex], vertices_[Next(vertex)]) < 0.0;
}

double Polygon::Area() const {
  return SignedArea(vertices_);
}

double Polygon::Perimeter() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < size(); ++k) sum += (vertices_[Next(k)] - vertices_[k]).norm();
  return sum;
}

bool Polygon::Contains(const Vector2d& point) const {
  bool inside = false;
  for (std::size_t k = 0; k < size(); ++k) {
    const Vector2d& a = vertices_[k];
    const Vector2d& b = vertices_[Next(k)];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    // The wall crosses the point's height; only what lies to the right of the point counts.
    if ((Orientation(a, b, point) > 0.0) == (b.y() > a.y())) inside = !inside;
  }
  return inside;
}

bool Polygon::Sees(const Vector2d& from, const Vector2d& to) const {
  for (std::size_t k = 0; k < size(); ++k) {
    const Vector2d& a = vertices_[k];
    const Vector2d& b = vertices_[Next(k)];
    if (a == from || a == to || b == from || b == to) continue;
    const double side_a = Orientation(from, to, a);
    const double side_b = Orientation(from, to, b);
    if (side_a * side_b < 0.0 && Orientation(a, b, from) * Orientation(a, b, to) < 0.0) return false;
  }
  return true;
}

Vector2d Polygon::FirstHit(const Vector2d& origin, const Vector2d& direction) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < size(); ++k) {
    const Vector2d& a = vertices_[k];
    const Vector2d& b = vertices_[Next(k)];
    if (a == origin || b == origin) continue;
    const double side_a = Cross(direction, a - origin);
    const double side_b = Cross(direction, b - origin);
    if ((side_a > 0.0) == (side_b > 0.0)) continue;
    // origin + t direction = a + s (b - a)
    const double t = Cross(a - origin, b - a) / Cross(direction, b - a);
    if (t > 0.0) nearest = std::min(nearest, t);
  }
  THALWEG_CHECK(std::isfinite(nearest));
  return origin + nearest * direction;
}

double Polygon::RoomAround(std::size_t vertex) const {
  const Vector2d& v = vertices_[vertex];
  const std::size_t before = Previous(vertex);
  const std::size_t after = Next(vertex);
  double room = std::min((vertices_[before] - v).norm(), (vertices_[after] - v).norm());
  for (std::size_t k = 0; k < size(); ++k) {
    if (k == before || k == vertex) continue;
    room = std::min(room, DistanceToWall(vertices_[k], vertices_[Next(k)], v));
  }
  return room;
}

}  // namespace thalweg::explorer
