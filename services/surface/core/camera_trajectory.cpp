#include "services/surface/core/camera_trajectory.h"

#include "services/surface/core/plane_normal.h"

namespace thalweg::surface {

RigidTransform LookingAlong(const Eigen::Vector3d& p_W, const Eigen::Vector3d& forward_W,
                            const RigidTransform& before) {
  Eigen::Vector3d right_W = forward_W.cross(Eigen::Vector3d::UnitZ());
  constexpr double kVertical = 1e-3;  // [rad] nearer to the vertical than this, it says nothing
  if (right_W.norm() < kVertical) {
    right_W = before.linear().col(0) - before.linear().col(0).dot(forward_W) * forward_W;
    // The camera before may have looked at right angles to this one.
    if (right_W.norm() < kVertical) right_W = forward_W.unitOrthogonal();
  }
  right_W.normalize();
  Eigen::Matrix3d R_WC;
  R_WC << right_W, forward_W.cross(right_W), forward_W;
  return MakeTransform(R_WC, p_W);
}

std::vector<RigidTransform> CameraTrajectory(
    const SurfaceGraph& graph, const std::vector<SurfaceGraph::Vertex>& path,
    const std::function<Eigen::Vector3d(SurfaceGraph::Vertex)>& camera_of, const Eigen::Vector3d& rift_normal,
    double height, const RigidTransform& before) {
  std::vector<RigidTransform> T_WCs;
  const auto add = [&](SurfaceGraph::Vertex vertex, const Eigen::Vector3d& normal) {
    T_WCs.push_back(LookingAlong(graph.Position(vertex).cast<double>() + height * normal, -normal,
                                 T_WCs.empty() ? before : T_WCs.back()));
  };
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const auto normal = PlaneNormal(graph, path[i], camera_of(path[i]));
    if (normal) add(path[i], *normal);
  }
  if (!path.empty()) add(path.back(), rift_normal);
  return T_WCs;
}

}  // namespace thalweg::surface
