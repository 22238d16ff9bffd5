#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <optional>
#include <random>
#include <vector>

#include "common/base/median.h"
#include "services/mapper/core/occupancy_map.h"
#include "tests/services/mapper/core/octomap_peer.h"
#include "tests/support/analytic_room.h"

// Integrates scans of a furnished room, and compares this with octomap::OcTree::insertPointCloud, lazy and
// discretized, on the same clouds, in processor time of the single thread that each uses. The two alternate
// scan by scan, so that other load on the machine affects both; columns are medians over scans. OctoMap gets
// its points already in W and is not charged for updateInnerOccupancy; ours transforms the points itself and
// lists what changed.

namespace thalweg::mapper {
namespace {

struct Scan {
  RigidTransform T_WC;
  PointCloud cloud;
  octomap::Pointcloud points_W;
};

std::vector<Scan> RenderScans(int width_px, int height_px) {
  const test::AnalyticRoom room = test::AnalyticRoom::Furnished();
  const auto camera = PinholeCamera::FromFieldOfView(width_px, height_px, width_px > 200 ? 1.152 : 1.309);
  std::mt19937 random(11);
  std::vector<Scan> scans(16);
  for (Scan& scan : scans) {
    scan.T_WC = room.RandomPose(random);
    scan.cloud = room.Render(camera, scan.T_WC, /*max_range=*/8.0);
    scan.points_W = test::OctomapPeer::ToWorld(scan.cloud, scan.T_WC);
  }
  return scans;
}

template <class Work>
double MillisecondsOf(Work&& work) {
  const auto now = [] {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
  };
  const double start = now();
  work();
  return now() - start;
}

/// Arguments: width, height [px], voxel size [mm], 1 = all rules, as in the shipped scenarios.
void IntegrateScan(benchmark::State& state) {
  const auto scans = RenderScans(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  OccupancyMap::Options options;
  options.voxel_size = static_cast<double>(state.range(2)) * 1e-3;
  const bool rules = state.range(3) != 0;
  options.protect = options.fill = options.exact_rays = rules;
  options.shadow = rules ? 3.0 : 0.0;
  std::optional<OccupancyMap> ours;
  std::optional<test::OctomapPeer> theirs;
  std::vector<double> ours_ms;
  std::vector<double> theirs_ms;
  std::size_t next = 0;
  for (auto _ : state) {
    if (next == 0) {  // a new exploration
      ours.emplace(options);
      theirs.emplace(options);
    }
    const Scan& scan = scans[next];
    next = (next + 1) % scans.size();
    ours_ms.push_back(MillisecondsOf([&] { ours->Integrate(scan.cloud, scan.T_WC); }));
    theirs_ms.push_back(
        MillisecondsOf([&] { theirs->Insert(scan.points_W, scan.T_WC, options.max_range, /*lazy=*/true); }));
    state.SetIterationTime(ours_ms.back() * 1e-3);
  }
  if (state.range(3) == 0 && theirs->Differences(ours->grid()) != 0) state.SkipWithError("maps differ");
  const double ours_median = Median(ours_ms);
  const double theirs_median = Median(theirs_ms);
  state.counters["ours_ms"] = ours_median;
  state.counters["octomap_ms"] = theirs_median;
  state.counters["ratio"] = theirs_median / ours_median;
}
BENCHMARK(IntegrateScan)
    ->ArgNames({"width", "height", "voxel_mm", "rules"})
    ->Args({100, 100, 100, 0})
    ->Args({512, 384, 100, 0})
    ->Args({100, 100, 50, 0})
    ->Args({512, 384, 50, 0})
    ->Args({100, 100, 100, 1})
    ->Args({512, 384, 100, 1})
    ->Args({100, 100, 50, 1})
    ->Args({512, 384, 50, 1})
    ->Iterations(96)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace thalweg::mapper
