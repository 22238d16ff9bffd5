#include "common/surface_graph/camera_trajectory.h"

#include <cmath>

#include "common/surface_graph/plane_normal.h"

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

std::vector<CameraPose> CameraTrajectory(
    const SurfaceGraph& graph, const std::vector<SurfaceGraph::Vertex>& path,
    const std::function<Eigen::Vector3d(SurfaceGraph::Vertex)>& camera_of, const Eigen::Vector3d& rift_normal,
    double height, const RigidTransform& before) {
  std::vector<CameraPose> poses;
  const auto add = [&](SurfaceGraph::Vertex vertex, const Eigen::Vector3d& normal) {
    const Eigen::Vector3d above_W = graph.Position(vertex).cast<double>();
    poses.push_back(
        {LookingAlong(above_W + height * normal, -normal, poses.empty() ? before : poses.back().T_WC),
         above_W});
  };
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const auto normal = PlaneNormal(graph, path[i], camera_of(path[i]));
    if (normal) add(path[i], *normal);
  }
  if (!path.empty()) add(path.back(), rift_normal);
  return poses;
}

std::vector<std::size_t> PlacesToLookFrom(std::size_t poses, int views) {
  std::vector<std::size_t> places;
  if (poses == 0) return places;
  const auto last = static_cast<double>(poses - 1);
  for (int k = 1; k <= views; ++k) places.push_back(static_cast<std::size_t>(std::lround(last * k / views)));
  return places;
}

std::vector<CameraPose> PosesToLookFrom(const std::vector<CameraPose>& poses, int views) {
  std::vector<CameraPose> chosen;
  for (const std::size_t place : PlacesToLookFrom(poses.size(), views)) chosen.push_back(poses[place]);
  return chosen;
}

}  // namespace thalweg::surface
