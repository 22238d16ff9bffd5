#include "services/explorer/core/gaps/visibility.h"

#include <algorithm>
#include <cmath>

namespace thalweg::explorer {
namespace {

using Eigen::Vector2d;

/// The vertices in sight, in the order of their directions; `hidden` as in HiddenSide.
struct Sight {
  double direction;
  std::size_t vertex;
  std::optional<GapSide> hidden;
};

std::vector<Sight> VerticesInSight(const Polygon& polygon, const Vector2d& viewpoint) {
  std::vector<Sight> sights;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    if (!polygon.Sees(viewpoint, polygon[k])) continue;
    const Vector2d to = polygon[k] - viewpoint;
    sights.push_back({std::atan2(to.y(), to.x()), k, HiddenSide(polygon, viewpoint, k)});
  }
  std::ranges::sort(sights, {}, &Sight::direction);
  return sights;
}

Vector2d Behind(const Polygon& polygon, const Vector2d& viewpoint, std::size_t vertex) {
  return polygon.FirstHit(polygon[vertex], polygon[vertex] - viewpoint);
}

/// The index of the wall on which a point lies.
std::size_t WallAt(const Polygon& polygon, const Vector2d& point) {
  const auto excess = [&](std::size_t k) {
    const Vector2d& a = polygon[k];
    const Vector2d& b = polygon[polygon.Next(k)];
    return (point - a).norm() + (point - b).norm() - (b - a).norm();
  };
  std::size_t best = 0;
  for (std::size_t k = 1; k < polygon.size(); ++k) {
    if (excess(k) < excess(best)) best = k;
  }
  return best;
}

}  // namespace

std::optional<GapSide> HiddenSide(const Polygon& polygon, const Vector2d& viewpoint, std::size_t vertex) {
  if (!polygon.IsReflex(vertex)) return std::nullopt;
  const Vector2d along = polygon[vertex] - viewpoint;
  const double before = Cross(along, polygon[polygon.Previous(vertex)] - polygon[vertex]);
  const double after = Cross(along, polygon[polygon.Next(vertex)] - polygon[vertex]);
  if (before > 0.0 && after > 0.0) return GapSide::kLeft;
  if (before < 0.0 && after < 0.0) return GapSide::kRight;
  return std::nullopt;
}

std::size_t HiddenNeighbor(const Polygon& polygon, std::size_t vertex, GapSide hidden) {
  return hidden == GapSide::kLeft ? polygon.Previous(vertex) : polygon.Next(vertex);
}

std::vector<Gap> SenseGaps(const Polygon& polygon, const Vector2d& viewpoint) {
  std::vector<Gap> gaps;
  for (const Sight& sight : VerticesInSight(polygon, viewpoint)) {
    if (sight.hidden) gaps.push_back({sight.direction, sight.vertex, *sight.hidden});
  }
  return gaps;
}

std::vector<Vector2d> VisibilityPolygon(const Polygon& polygon, const Vector2d& viewpoint) {
  std::vector<Vector2d> outline;
  for (const Sight& sight : VerticesInSight(polygon, viewpoint)) {
    // Counterclockwise, a vertex that hides its left is preceded by what lies behind it.
    if (sight.hidden == GapSide::kLeft) outline.push_back(Behind(polygon, viewpoint, sight.vertex));
    outline.push_back(polygon[sight.vertex]);
    if (sight.hidden == GapSide::kRight) outline.push_back(Behind(polygon, viewpoint, sight.vertex));
  }
  return outline;
}

std::vector<Vector2d> PocketOf(const Polygon& polygon, const Vector2d& viewpoint, const Gap& gap) {
  const Vector2d hit = Behind(polygon, viewpoint, gap.vertex);
  const std::size_t wall = WallAt(polygon, hit);
  std::vector<Vector2d> pocket;
  // The walls run counterclockwise: from the hit to a vertex that hides its left, from one that hides its
  // right to the hit.
  const bool left = gap.hidden == GapSide::kLeft;
  const std::size_t first = left ? polygon.Next(wall) : gap.vertex;
  const std::size_t last = left ? gap.vertex : wall;
  for (std::size_t k = first;; k = polygon.Next(k)) {
    pocket.push_back(polygon[k]);
    if (k == last) break;
  }
  pocket.push_back(hit);
  return pocket;
}

bool IsSeenFromSegment(const Polygon& polygon, const Vector2d& from, const Vector2d& to,
                       const Vector2d& point) {
  // Shares of the way at which the line of sight passes a vertex: (v - p) x (from + s (to - from) - p) = 0.
  std::vector<double> changes = {0.0, 1.0};
  for (const Vector2d& v : polygon.vertices()) {
    const double slope = Cross(v - point, to - from);
    if (slope == 0.0) continue;
    const double share = -Cross(v - point, from - point) / slope;
    if (share > 0.0 && share < 1.0) changes.push_back(share);
  }
  std::ranges::sort(changes);
  for (std::size_t k = 1; k < changes.size(); ++k) {
    const double middle = (changes[k - 1] + changes[k]) / 2.0;
    if (polygon.Sees(point, from + middle * (to - from))) return true;
  }
  return false;
}

}  // namespace thalweg::explorer
