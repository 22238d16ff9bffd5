#pragma once

#include "common/geometry/robot_model.h"
#include "services/evaluator/core/seen_surface.h"
#include "services/evaluator/core/surface_truth.h"
#include "services/surface/core/fused/fused_surface.h"
#include "services/surface/core/fused/surface_mesh.h"

namespace thalweg::evaluator {

/// How well a run has seen the surfaces of a world, and how good the mesh is that it leaves.
///
/// Precision P(t) is the share of the mesh's area within t of a true surface, recall R(t) the share of the
/// observable surface within t of the mesh, F = 2 P R / (P + R) [Knapitsch et al., Tanks and Temples, ACM TOG
/// 36(4), 2017, Sec. 5].
struct SurfaceFigures {
  double observable = 0.0;  ///< [m^2]
  double seen = 0.0;        ///< Share of it that was in view of a scan, with nothing in between.
  double inspected = 0.0;   ///< Share of it that one scan saw near and square enough, see InspectionLimits.
  double fine = 0.0;        ///< Share of it that a scan sampled finely enough.
  double mesh_area = 0.0;   ///< [m^2]
  /// [m] Mean distance of the mesh from the nearest true surface; at most kFarthest counts.
  double mesh_to_truth = 0.0;
  double truth_to_mesh = 0.0;  ///< [m] Mean distance of the observable surface from the mesh, likewise.
  double f_near = 0.0;         ///< F-score within kNear.
  double f_voxel = 0.0;        ///< F-score within a voxel of the occupancy map.

  static constexpr double kNear = 0.02;      ///< [m]
  static constexpr double kFarthest = 0.50;  ///< [m]

  bool operator==(const SurfaceFigures&) const = default;
};

/// Fuses the scans of a run, and notes which part of the true surface each of them saw.
class SurfaceRecorder {
 public:
  /// @param world, truth  Must outlive the recorder.
  SurfaceRecorder(const simulator::World& world, const SurfaceTruth& truth, const DepthSensorModel& sensor,
                  const surface::FusedSurface::Options& options);

  /// @param T_WC       Where the robot takes its camera to be.
  /// @param T_WC_true  Where it is.
  void OnScan(const PointCloud& cloud, const RigidTransform& T_WC, const RigidTransform& T_WC_true);

  /// Compares with the truth. @param map_voxel  [m]
  SurfaceFigures Figures(double map_voxel) const;
  const surface::SurfaceMesh& mesh() const { return mesh_; }
  /// Whether the surface has taken the memory that it may, so that nothing new is added.
  bool full() const { return surface_.full(); }

 private:
  const simulator::World& world_;
  const SurfaceTruth& truth_;
  PinholeCamera camera_;
  surface::FusedSurface surface_;
  surface::SurfaceMesh mesh_;
  SeenSurface seen_;
};

}  // namespace thalweg::evaluator
