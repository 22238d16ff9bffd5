#pragma once

#include <limits>
#include <utility>

#include "common/surface_graph/view.h"

/// Views of surfaces that are known in closed form. In all of them the camera frame is W unless said.
namespace thalweg::surface::test {

inline constexpr double kNothing = std::numeric_limits<double>::infinity();

inline StereoGeometry Rig(int width_px, int height_px, double f) {
  return {{width_px, height_px, f, f, 0.5 * (width_px - 1), 0.5 * (height_px - 1)}, 0.12};
}

/// @param depth_along(origin_W, ray_W)  How many times the ray, of unit depth, fits before the surface;
/// kNothing = no surface.
template <class DepthAlong>
View ViewOf(const StereoGeometry& rig, const RigidTransform& T_WC, DepthAlong&& depth_along) {
  DepthImage depth{rig.camera.width_px, rig.camera.height_px, {}};
  for (int v = 0; v < depth.height_px; ++v) {
    for (int u = 0; u < depth.width_px; ++u) {
      const Eigen::Vector3d ray_W = T_WC.linear() * rig.camera.RayAtUnitDepth(u, v);
      depth.depths.push_back(static_cast<float>(depth_along(Eigen::Vector3d(T_WC.translation()), ray_W)));
    }
  }
  return {.rig = rig, .disparities = DisparitiesOf(depth, rig), .colors = {}, .T_WC = T_WC};
}

/// Depth of the plane z = `z`.
inline double PlaneAt(double z, const Eigen::Vector3d& origin_W, const Eigen::Vector3d& ray_W) {
  const double along = (z - origin_W.z()) / ray_W.z();
  return along > 0.0 ? along : kNothing;
}

/// Depth of a sphere.
inline double SphereAt(const Eigen::Vector3d& center_W, double radius, const Eigen::Vector3d& origin_W,
                       const Eigen::Vector3d& ray_W) {
  const Eigen::Vector3d to_origin = origin_W - center_W;
  const double a = ray_W.squaredNorm();
  const double b = ray_W.dot(to_origin);
  const double c = to_origin.squaredNorm() - radius * radius;
  const double discriminant = b * b - a * c;
  return discriminant < 0.0 ? kNothing : (-b - std::sqrt(discriminant)) / a;
}

inline RigidTransform Shifted(const Eigen::Vector3d& p_W) {
  return MakeTransform(Eigen::Matrix3d::Identity(), p_W);
}

/// Views of one plane from two places, the second by whole pixels further to the right.
inline std::pair<View, View> PlaneTwice(const StereoGeometry& rig, double z, int pixels) {
  const auto plane = [&](const Eigen::Vector3d& o, const Eigen::Vector3d& r) { return PlaneAt(z, o, r); };
  return {ViewOf(rig, Shifted({0, 0, 0}), plane),
          ViewOf(rig, Shifted({pixels * z / rig.camera.fx, 0, 0}), plane)};
}

/// A wall at z = 2 left of x = 0, and one at z = 4 behind it.
inline double StepAt(const Eigen::Vector3d& origin_W, const Eigen::Vector3d& ray_W) {
  const double near = PlaneAt(2.0, origin_W, ray_W);
  if (near < kNothing && (origin_W + near * ray_W).x() < 0.0) return near;
  return PlaneAt(4.0, origin_W, ray_W);
}

}  // namespace thalweg::surface::test
