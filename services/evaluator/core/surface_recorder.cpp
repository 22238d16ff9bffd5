#include "services/evaluator/core/surface_recorder.h"

#include <Eigen/Geometry>

namespace thalweg::evaluator {
namespace {

double FScore(double precision, double recall) {
  return precision + recall > 0.0 ? 2.0 * precision * recall / (precision + recall) : 0.0;
}

/// Sums up distances, with weights.
struct Distances {
  explicit Distances(double voxel_size) : voxel(voxel_size) {}
  void Add(double distance, double weight) {
    all += weight;
    sum += weight * distance;
    if (distance <= SurfaceFigures::kNear) near += weight;
    if (distance <= voxel) within_voxel += weight;
  }
  double Share(double part) const { return all > 0.0 ? part / all : 0.0; }
  double voxel;
  double all = 0.0, sum = 0.0, near = 0.0, within_voxel = 0.0;
};

}  // namespace

SurfaceRecorder::SurfaceRecorder(const simulator::World& world, const SurfaceTruth& truth,
                                 const DepthSensorModel& sensor,
                                 const surface::FusedSurface::Options& options)
    : world_(world),
      truth_(truth),
      camera_(sensor.camera),
      surface_(options),
      mesh_(options.limits),
      seen_(world, truth, sensor.camera, sensor.max_range, surface_.options().limits) {}

void SurfaceRecorder::OnScan(const PointCloud& cloud, const RigidTransform& T_WC,
                             const RigidTransform& T_WC_true) {
  mesh_.Update(surface_.volume(), surface_.Fuse(cloud, camera_, T_WC));
  seen_.Note(T_WC_true);
}

SurfaceFigures SurfaceRecorder::Figures(double map_voxel) const {
  SurfaceFigures figures{.observable = truth_.area(), .mesh_area = mesh_.area().seen};
  figures.seen = seen_.seen();
  figures.inspected = seen_.inspected();
  figures.fine = seen_.fine();
  const surface::TriangleMesh mesh = mesh_.Joined();
  if (mesh.faces.empty()) {
    figures.truth_to_mesh = SurfaceFigures::kFarthest;
    return figures;
  }
  Distances precision(map_voxel);
  for (const auto& [a, b, c] : mesh.faces) {
    // A face is so small that its center stands for it.
    const Eigen::Vector3f& p = mesh.vertices_W[a];
    const Eigen::Vector3f center = (p + mesh.vertices_W[b] + mesh.vertices_W[c]) / 3.0F;
    const double area =
        0.5 * static_cast<double>((mesh.vertices_W[b] - p).cross(mesh.vertices_W[c] - p).norm());
    precision.Add(world_.DistanceToSurface(center.cast<double>(), SurfaceFigures::kFarthest), area);
  }
  simulator::Mesh triangles;
  triangles.vertices = mesh.vertices_W;
  triangles.triangles = mesh.faces;
  const simulator::World fused(std::move(triangles), world_.bounds());
  Distances recall(map_voxel);
  for (const SurfaceTruth::Point& point : truth_.points) {
    recall.Add(fused.DistanceToSurface(point.p_W, SurfaceFigures::kFarthest), 1.0);
  }
  figures.mesh_to_truth = precision.Share(precision.sum);
  figures.truth_to_mesh = recall.Share(recall.sum);
  figures.f_near = FScore(precision.Share(precision.near), recall.Share(recall.near));
  figures.f_voxel = FScore(precision.Share(precision.within_voxel), recall.Share(recall.within_voxel));
  return figures;
}

}  // namespace thalweg::evaluator
