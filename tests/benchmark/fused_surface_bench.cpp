#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <ctime>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "common/base/stopwatch.h"
#include "services/surface/core/fused/fused_surface.h"
#include "services/surface/core/fused/live_surface.h"
#include "services/surface/core/fused/mesh_rifts.h"
#include "services/surface/core/fused/surface_mesh.h"
#include "tests/support/analytic_room.h"
#include "tests/support/resident_memory.h"

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

/// [ms] Processor time of this thread.
double ProcessorMilliseconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

/// What a hundred scans took, and what there is after them.
struct Hundred {
  double fuse = 0.0;   // [ms] Processor time, of all of them,
  double mesh = 0.0;   // [ms] of the mesh,
  double rifts = 0.0;  // [ms] and of the rifts.
  std::size_t blocks = 0;
  std::size_t vertices = 0;
  double volume_mb = 0.0;
  double mesh_mb = 0.0;
  double resident_mb = 0.0;
  std::size_t open_rifts = 0;
};

constexpr int kHundreds = 10;
/// As the service does by default with a camera of 5 Hz: a mesh every second, a checkpoint every ten.
constexpr int kScansPerMesh = 5;
constexpr int kScansPerCheckpoint = 50;

/// Fuses a thousand scans of the furnished room as the service does, with noise that is new in each.
template <class PoseOf>
std::vector<Hundred> FuseAThousand(double voxel_size, PoseOf&& pose_of) {
  const auto room = test::AnalyticRoom::Furnished();
  const FusedSurface::Options options{.voxel_size = voxel_size, .depth_error = {.sigma = 0.002}};
  LiveSurface live(options, TruncatedVolume(options.voxel_size));
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, options.depth_error.sigma);
  std::vector<Hundred> hundreds;
  for (int k = 0; k < 100 * kHundreds; ++k) {
    if (k % 100 == 0) hundreds.emplace_back();
    Hundred& now = hundreds.back();
    const RigidTransform T_WC = pose_of(k);
    PointCloud cloud = room.Render(kCoarse, T_WC);
    for (Eigen::Vector3f& p_C : cloud.points_C)
      p_C /= 1.0F + p_C.z() * static_cast<float>(noise(random));  // an error of 1 / z
    cloud.colors.assign(cloud.points_C.size(), {90, 120, 150});
    const auto timed = [](double& sum, auto&& work) {
      const double before = ProcessorMilliseconds();
      work();
      sum += ProcessorMilliseconds() - before;
    };
    timed(now.fuse, [&] { live.Fuse(cloud, kCoarse, T_WC); });
    if ((k + 1) % kScansPerMesh == 0) {
      timed(now.mesh, [&] { live.TakeUpdated(); });
      timed(now.rifts, [&] { live.FindRifts(); });
    }
    if ((k + 1) % kScansPerCheckpoint == 0) live.TakeChanged();
    if ((k + 1) % 100 != 0) continue;
    now.blocks = live.surface().volume().block_count();
    now.volume_mb = static_cast<double>(live.surface().volume().bytes()) * 1e-6;
    for (const auto& [index, mesh] : live.mesh().blocks()) {
      now.vertices += mesh.vertices.size();
      now.mesh_mb += 1e-6 * static_cast<double>(mesh.vertices.size() * sizeof mesh.vertices[0] +
                                                mesh.faces.size() * sizeof mesh.faces[0]);
    }
    now.resident_mb = test::ResidentMegabytes();
    now.open_rifts = live.rifts().open().size();
  }
  return hundreds;
}

std::vector<Hundred> StandStill(double voxel_size) {
  return FuseAThousand(voxel_size, [](int /*k*/) {
    return MakeTransform(RotationFromYawPitch(0.3, -0.1) * BodyFromOptical(), Eigen::Vector3d(-2.5, -1, 0.2));
  });
}

/// Looking ahead on a circle of 1 m, a hundred scans a lap and a bit, so that no pose comes twice.
std::vector<Hundred> GoRound(double voxel_size) {
  return FuseAThousand(voxel_size, [](int k) {
    const double angle = 2.0 * std::numbers::pi * k / 100.3;
    return MakeTransform(
        RotationFromYawPitch(angle + 0.5 * std::numbers::pi, 0.2 * std::sin(2.0 * angle)) * BodyFromOptical(),
        Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.2));
  });
}

/// Whether time and memory follow what is new, or the number of scans. Arguments: the voxel [mm], and which
/// hundred of a thousand scans; the time is the processor's, per scan. All are fused when one is first asked
/// for.
void EachHundred(benchmark::State& state, std::vector<Hundred> (*fuse)(double)) {
  static std::map<std::pair<std::vector<Hundred> (*)(double), std::int64_t>, std::vector<Hundred>> fused;
  std::vector<Hundred>& hundreds = fused[{fuse, state.range(0)}];
  if (hundreds.empty()) hundreds = fuse(1e-3 * static_cast<double>(state.range(0)));
  const Hundred& hundred = hundreds[static_cast<std::size_t>(state.range(1)) - 1];
  for (auto _ : state) state.SetIterationTime(1e-5 * (hundred.fuse + hundred.mesh + hundred.rifts));
  state.counters["fuse_ms"] = 1e-2 * hundred.fuse;
  state.counters["mesh_ms"] = 1e-2 * hundred.mesh;
  state.counters["rifts_ms"] = 1e-2 * hundred.rifts;
  state.counters["blocks"] = static_cast<double>(hundred.blocks);
  state.counters["vertices"] = static_cast<double>(hundred.vertices);
  state.counters["volume_MB"] = hundred.volume_mb;
  state.counters["mesh_MB"] = hundred.mesh_mb;
  state.counters["resident_MB"] = hundred.resident_mb;
  state.counters["rifts"] = static_cast<double>(hundred.open_rifts);
}
BENCHMARK_CAPTURE(EachHundred, Standing, StandStill)
    ->ArgsProduct({{20, 40}, benchmark::CreateDenseRange(1, kHundreds, 1)})
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(EachHundred, Round, GoRound)
    ->ArgsProduct({{20, 40}, benchmark::CreateDenseRange(1, kHundreds, 1)})
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace thalweg::surface
