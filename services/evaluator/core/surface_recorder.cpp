#include "services/evaluator/core/surface_recorder.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace thalweg::evaluator {
namespace {

constexpr std::uint8_t kSeen = 1;
constexpr std::uint8_t kInspected = 2;
constexpr std::uint8_t kFine = 4;

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
      sensor_(sensor),
      surface_(options),
      mesh_(options.limits),
      seen_(truth.points.size(), 0) {}

void SurfaceRecorder::OnScan(const PointCloud& cloud, const RigidTransform& T_WC,
                             const RigidTransform& T_WC_true) {
  mesh_.Update(surface_.volume(), surface_.Fuse(cloud, sensor_.camera, T_WC));
  NoteSeen(T_WC_true);
}

void SurfaceRecorder::NoteSeen(const RigidTransform& T_WC_true) {
  const Eigen::Vector3d eye_W = T_WC_true.translation();
  const RigidTransform T_CW = T_WC_true.inverse();
  const double f = std::min(sensor_.camera.fx, sensor_.camera.fy);
  const surface::InspectionLimits& limits = surface_.options().limits;
  for (std::size_t k = 0; k < truth_.points.size(); ++k) {
    const SurfaceTruth::Point& point = truth_.points[k];
    const Eigen::Vector3d to_eye = eye_W - point.p_W;
    const double distance = to_eye.norm();
    if (distance > sensor_.max_range) continue;
    const double cosine = point.normal_W.dot(to_eye) / distance;
    if (cosine <= 0.0) continue;
    const Eigen::Vector3d p_C = T_CW * point.p_W;
    const surface::ViewQuality view{.distance = static_cast<float>(distance),
                                    .cosine = static_cast<float>(cosine),
                                    .sampling = static_cast<float>(p_C.z() / (f * cosine))};
    unsigned shows = kSeen;
    if (limits.Inspects(view)) shows |= kInspected;
    if (limits.SamplesFinely(view)) shows |= kFine;
    if ((shows & ~static_cast<unsigned>(seen_[k])) == 0 || !sensor_.camera.Sees(p_C)) continue;
    if (!world_.InSight(eye_W, point.before_W())) continue;
    seen_[k] = static_cast<std::uint8_t>(seen_[k] | shows);
  }
}

SurfaceFigures SurfaceRecorder::Figures(double map_voxel) const {
  SurfaceFigures figures{.observable = truth_.area(), .mesh_area = mesh_.area().seen};
  const auto share = [&](std::uint8_t what) {
    const auto count = std::ranges::count_if(seen_, [&](std::uint8_t seen) { return (seen & what) != 0; });
    return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, seen_.size()));
  };
  figures.seen = share(kSeen);
  figures.inspected = share(kInspected);
  figures.fine = share(kFine);
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
