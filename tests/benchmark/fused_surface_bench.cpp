#include <benchmark/benchmark.h>

#include <random>
#include <vector>

#include "common/base/stopwatch.h"
#include "services/surface/core/fused/fused_surface.h"
#include "services/surface/core/fused/mesh_rifts.h"
#include "services/surface/core/fused/surface_mesh.h"
#include "tests/support/analytic_room.h"

namespace thalweg::surface {
namespace {

struct Flight {
  PinholeCamera camera;
  std::vector<RigidTransform> poses;
  std::vector<PointCloud> clouds;
};

/// Scans of a furnished room of 8 x 6 x 3 m on a walk through it, which turns all around.
Flight Through(const PinholeCamera& camera, int scans) {
  const auto room = test::AnalyticRoom::Furnished();
  Flight flight{camera, {}, {}};
  for (int k = 0; k < scans; ++k) {
    const Eigen::Vector3d p_W(-0.5 + 0.015 * k, 0.0, 0.2);
    flight.poses.push_back(
        MakeTransform(RotationFromYawPitch(0.15 * k, 0.3 * std::sin(0.1 * k)) * BodyFromOptical(), p_W));
    flight.clouds.push_back(room.Render(camera, flight.poses.back()));
    flight.clouds.back().colors.assign(flight.clouds.back().points_C.size(), {90, 120, 150});
  }
  return flight;
}

const PinholeCamera kCoarse = PinholeCamera::FromFieldOfView(100, 100, 1.309);
const PinholeCamera kFine = PinholeCamera::FromFieldOfView(512, 384, 1.15);

/// Per scan, mesh included; arguments: the voxel [mm], the sensor's stated error [1e-4 / m].
void FuseAndMesh(benchmark::State& state, const PinholeCamera& camera) {
  const Flight flight = Through(camera, 60);
  const FusedSurface::Options options{.voxel_size = 1e-3 * static_cast<double>(state.range(0)),
                                      .depth_error = {.sigma = 1e-4 * static_cast<double>(state.range(1))}};
  for (auto _ : state) {
    FusedSurface surface(options);
    SurfaceMesh mesh(options.limits);
    for (std::size_t k = 0; k < flight.clouds.size(); ++k) {
      const auto changed = surface.Fuse(flight.clouds[k], camera, flight.poses[k]);
      mesh.Update(surface.volume(), changed);
    }
    state.counters["blocks"] = static_cast<double>(surface.volume().block_count());
    state.counters["MB"] = static_cast<double>(surface.volume().bytes()) * 1e-6;
    state.counters["m2"] = mesh.area().seen;
  }
  state.counters["s_per_scan"] =
      benchmark::Counter(static_cast<double>(flight.clouds.size()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(FuseAndMesh, Coarse, kCoarse)
    ->Args({20, 0})
    ->Args({40, 0})
    ->Args({20, 20})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(FuseAndMesh, Fine, kFine)
    ->Args({20, 0})
    ->Args({40, 0})
    ->Args({20, 20})
    ->Unit(benchmark::kMillisecond);

/// What keeping the rifts takes, per scan: following the mesh, and finding them. Not what the mesh takes.
void Rifts(benchmark::State& state, const PinholeCamera& camera) {
  const Flight flight = Through(camera, 60);
  const FusedSurface::Options options{.voxel_size = 1e-3 * static_cast<double>(state.range(0))};
  double follow = 0.0;  // [s]
  double find = 0.0;    // [s]
  for (auto _ : state) {
    FusedSurface surface(options);
    SurfaceMesh mesh(options.limits);
    MeshRifts rifts(options.voxel_size, options.depth_error);
    std::size_t edges = 0;
    for (std::size_t k = 0; k < flight.clouds.size(); ++k) {
      const auto updated =
          mesh.Update(surface.volume(), surface.Fuse(flight.clouds[k], camera, flight.poses[k]));
      const Stopwatch following;
      rifts.Update(mesh, updated);
      follow += 1e-3 * following.Milliseconds();
      const Stopwatch finding;
      rifts.Find(mesh, flight.poses[k] *
                           flight.clouds[k].points_C[flight.clouds[k].points_C.size() / 2].cast<double>());
      find += 1e-3 * finding.Milliseconds();
    }
    for (const MeshRift& rift : rifts.open()) edges += rift.edges;
    state.counters["rifts"] = static_cast<double>(rifts.open().size());
    state.counters["edges"] = static_cast<double>(edges);
    state.counters["m2"] = mesh.area().seen;
  }
  const auto per_scan = [&](double seconds) {
    return benchmark::Counter(seconds / static_cast<double>(flight.clouds.size()),
                              benchmark::Counter::kAvgIterations);
  };
  state.counters["follow_s"] = per_scan(follow);
  state.counters["find_s"] = per_scan(find);
}
BENCHMARK_CAPTURE(Rifts, Coarse, kCoarse)->Arg(20)->Arg(40)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Rifts, Fine, kFine)->Arg(20)->Arg(40)->Unit(benchmark::kMillisecond);

/// Fusing alone, without a mesh.
void Fuse(benchmark::State& state, const PinholeCamera& camera) {
  const Flight flight = Through(camera, 60);
  for (auto _ : state) {
    FusedSurface surface({.voxel_size = 1e-3 * static_cast<double>(state.range(0))});
    for (std::size_t k = 0; k < flight.clouds.size(); ++k)
      surface.Fuse(flight.clouds[k], camera, flight.poses[k]);
  }
  state.counters["s_per_scan"] =
      benchmark::Counter(static_cast<double>(flight.clouds.size()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(Fuse, Coarse, kCoarse)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Fuse, Fine, kFine)->Arg(20)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace thalweg::surface
