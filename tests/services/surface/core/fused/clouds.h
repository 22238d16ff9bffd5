#pragma once

#include <limits>
#include <optional>

#include "services/surface/core/fused/fused_surface.h"
#include "services/surface/core/fused/surface_mesh.h"

/// Clouds of surfaces that are known in closed form, and figures of meshes.
namespace thalweg::surface::test {

inline constexpr double kNoSurface = std::numeric_limits<double>::infinity();

inline RigidTransform LookingAlong(const Eigen::Vector3d& eye_W, double yaw, double pitch) {
  return MakeTransform(RotationFromYawPitch(yaw, pitch) * BodyFromOptical(), eye_W);
}

/// A pose at `eye_W` from which `target_W` is in the middle of the image.
inline RigidTransform LookingAt(const Eigen::Vector3d& eye_W, const Eigen::Vector3d& target_W) {
  const Eigen::Vector3d d = target_W - eye_W;
  return LookingAlong(eye_W, std::atan2(d.y(), d.x()), std::atan2(d.z(), std::hypot(d.x(), d.y())));
}

/// @param distance_along(origin_W, direction_W)  To the first surface along a ray of unit length; kNoSurface
/// = not measured.
template <class DistanceAlong>
PointCloud CloudOf(const PinholeCamera& camera, const RigidTransform& T_WC, DistanceAlong&& distance_along) {
  PointCloud cloud{.width_px = camera.width_px, .height_px = camera.height_px, .points_C = {}, .colors = {}};
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      const Eigen::Vector3d ray_C = camera.RayAtUnitDepth(u, v).normalized();
      const double distance =
          distance_along(Eigen::Vector3d(T_WC.translation()), Eigen::Vector3d(T_WC.linear() * ray_C));
      cloud.points_C.push_back(distance < kNoSurface
                                   ? (distance * ray_C).cast<float>().eval()
                                   : Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
    }
  }
  return cloud;
}

/// Distance along a ray to a sphere from outside.
inline double ToSphere(const Eigen::Vector3d& center_W, double radius, const Eigen::Vector3d& origin_W,
                       const Eigen::Vector3d& direction_W) {
  const Eigen::Vector3d offset = origin_W - center_W;
  const double b = direction_W.dot(offset);
  const double discriminant = b * b - offset.squaredNorm() + radius * radius;
  return discriminant < 0.0 ? kNoSurface : -b - std::sqrt(discriminant);
}

/// Distance along a ray to a box from outside.
inline double ToBox(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& origin_W,
                    const Eigen::Vector3d& direction_W) {
  const Eigen::Array3d a = (box.min() - origin_W).array() / direction_W.array();
  const Eigen::Array3d b = (box.max() - origin_W).array() / direction_W.array();
  const double enter = a.min(b).maxCoeff();
  return enter <= a.max(b).minCoeff() && enter > 0.0 ? enter : kNoSurface;
}

/// The plane through a point, from either side.
inline double ToPlane(const Eigen::Vector3d& p_W, const Eigen::Vector3d& normal_W,
                      const Eigen::Vector3d& origin_W, const Eigen::Vector3d& direction_W) {
  const double along = (p_W - origin_W).dot(normal_W) / direction_W.dot(normal_W);
  return along > 0.0 ? along : kNoSurface;
}

/// A surface and its mesh, fed with views.
struct Fusion {
  explicit Fusion(const FusedSurface::Options& options) : surface(options), mesh(options.limits) {}
  template <class DistanceAlong>
  void See(const PinholeCamera& camera, const RigidTransform& T_WC, DistanceAlong&& distance_along) {
    mesh.Update(surface.volume(), surface.Fuse(CloudOf(camera, T_WC, distance_along), camera, T_WC));
  }
  FusedSurface surface;
  SurfaceMesh mesh;
};

inline double AreaOf(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const auto& [a, b, c] : mesh.faces) {
    const Eigen::Vector3f p = mesh.vertices_W[a];
    area += 0.5 * static_cast<double>((mesh.vertices_W[b] - p).cross(mesh.vertices_W[c] - p).norm());
  }
  return area;
}

/// The largest and the mean distance of the vertices from a surface.
/// @param distance_of(p_W)  [m]
template <class DistanceOf>
std::pair<double, double> ErrorsOf(const TriangleMesh& mesh, DistanceOf&& distance_of) {
  double most = 0.0;
  double sum = 0.0;
  for (const Eigen::Vector3f& vertex : mesh.vertices_W) {
    const double error = std::abs(distance_of(Eigen::Vector3d(vertex.cast<double>())));
    most = std::max(most, error);
    sum += error;
  }
  return {most, sum / static_cast<double>(mesh.vertices_W.size())};
}

}  // namespace thalweg::surface::test
