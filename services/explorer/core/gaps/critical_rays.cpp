#include "services/explorer/core/gaps/critical_rays.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace thalweg::explorer {
namespace {

using Eigen::Vector2d;

constexpr double kOnTheLine = 1e-10;  ///< [m] Vertices that are nearer than this to a ray lie on it.

void CheckGeneralPosition(const Polygon& polygon, const CriticalRay& ray) {
  const Vector2d& far = polygon[ray.far];
  const Vector2d along = (ray.end - far).normalized();
  const double length = (ray.end - far).norm();
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    if (k == ray.near || k == ray.far) continue;
    const double at = along.dot(polygon[k] - far);
    if (at < 0.0 || at > length + kOnTheLine || std::abs(Cross(along, polygon[k] - far)) > kOnTheLine)
      continue;
    throw std::invalid_argument("the polygon is not in general position: vertices " +
                                std::to_string(ray.near) + ", " + std::to_string(ray.far) + " and " +
                                std::to_string(k) + " lie on a line");
  }
}

CriticalRay RayFrom(const Polygon& polygon, CriticalRay::Kind kind, std::size_t near, std::size_t far,
                    GapSide hidden) {
  const Vector2d& start = polygon[near];
  CriticalRay ray{kind, near, far, hidden, start, polygon.FirstHit(start, start - polygon[far])};
  CheckGeneralPosition(polygon, ray);
  return ray;
}

}  // namespace

std::vector<CriticalRay> CriticalRays(const Polygon& polygon) {
  using Kind = CriticalRay::Kind;
  std::vector<CriticalRay> rays;
  for (std::size_t near = 0; near < polygon.size(); ++near) {
    if (!polygon.IsReflex(near)) continue;
    for (const GapSide hidden : {GapSide::kLeft, GapSide::kRight}) {
      const std::size_t far = HiddenNeighbor(polygon, near, hidden);
      rays.push_back(
          RayFrom(polygon, polygon.IsReflex(far) ? Kind::kSlide : Kind::kInflection, near, far, hidden));
    }
    for (std::size_t far = 0; far < polygon.size(); ++far) {
      if (far == near || far == polygon.Previous(near) || far == polygon.Next(near)) continue;
      // Looking from one to the other touches both of them: what each hides lies on a single side.
      const auto hidden = HiddenSide(polygon, polygon[far], near);
      if (!hidden || !HiddenSide(polygon, polygon[near], far)) continue;
      if (!polygon.Sees(polygon[near], polygon[far])) continue;
      // HiddenSide looks from `far` to `near`, a ray's side is meant looking from `near` to `far`.
      const GapSide turned = *hidden == GapSide::kLeft ? GapSide::kRight : GapSide::kLeft;
      rays.push_back(RayFrom(polygon, Kind::kBitangent, near, far, turned));
    }
  }
  return rays;
}

}  // namespace thalweg::explorer
