// Effect of depth sensor noise on the map: random views of a scenario's world, fused with and without noise,
// and compared voxel by voxel with each other and with the ground truth.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "common/base/stopwatch.h"
#include "common/scenario/scenario.h"
#include "services/evaluator/adapter/scene.h"
#include "services/simulator/core/depth_sensor.h"

namespace thalweg {
namespace {

struct Mapped {
  mapper::OccupancyMap map;
  double milliseconds;  ///< Per scan.
};

Mapped Map(const evaluator::Scene& scene, int views) {
  const evaluator::LockstepOptions options = scene.Options("", 1);
  simulator::DepthSensor sensor(options.sensor, 1, /*colors=*/false);
  mapper::OccupancyMap map(options.mapper);
  double spent = 0.0;
  for (int view = 1; view <= views; ++view) {
    // Level views would never see the ceiling.
    RigidTransform T_WB = scene.Start(view);
    T_WB.linear() *= RotationFromYawPitch(0.0, 0.5 * (view % 5 - 2));
    const RigidTransform T_WC = T_WB * options.robot.T_BC;
    const PointCloud cloud = sensor.Capture(scene.world(), T_WC);
    const Stopwatch watch;
    map.Integrate(cloud, T_WC);
    spent += watch.Milliseconds();
  }
  return {std::move(map), spent / views};
}

/// Share of voxels with the same state in both maps, among those known in either.
double SameShare(const OccupancyGrid& a, const OccupancyGrid& b) {
  std::size_t same = 0, either = 0;
  a.ForEachKnown([&](const VoxelIndex& i, float log_odds) {
    ++either;
    if (OccupancyGrid::StateOf(log_odds) == b.State(i)) ++same;
  });
  b.ForEachKnown([&](const VoxelIndex& i, float) {
    if (a.State(i) == VoxelState::kUnknown) ++either;
  });
  return static_cast<double>(same) / static_cast<double>(either);
}

int Main(int argc, char** argv) {
  std::string name = kDefaultScenario;
  int views = 300;
  std::vector<double> noises = {0.0, 0.195, 1.0};
  std::vector<std::string> overrides;
  CLI::App app("What noise of the depth sensor does to the map.");
  app.add_option("scenario", name)->capture_default_str();
  app.add_option("--views", views)->capture_default_str();
  app.add_option("--noise", noises, "sigma of disparity, in pixels");
  app.add_option("--set", overrides, "PATH=VALUE");
  CLI11_PARSE(app, argc, argv);
  const evaluator::Scene exact(name, overrides);
  const Mapped reference = Map(exact, views);
  const auto truth = exact.Truth(exact.Start(0).translation());
  std::printf("noise [px]  as without noise  known  right of known  false free  false occupied  ms a scan\n");
  for (const double noise : noises) {
    std::vector<std::string> with = overrides;
    with.push_back("depth_sensor.disparity_noise_px=" + std::to_string(noise));
    const Mapped mapped = Map(evaluator::Scene(name, with), views);
    const simulator::TrueMap::Agreement agreement = truth->Compare(mapped.map.grid());
    std::printf("%10.3f  %15.2f%%  %4.1f%%  %13.2f%%  %10zu  %14zu  %9.2f\n", noise,
                100 * SameShare(reference.map.grid(), mapped.map.grid()), 100 * agreement.coverage(),
                100 * agreement.share() / agreement.coverage(), agreement.surface_wrong, agreement.free_wrong,
                mapped.milliseconds);
  }
  return 0;
}

}  // namespace
}  // namespace thalweg

int main(int argc, char** argv) {
  try {
    return thalweg::Main(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "bench_mapper_noise: " << error.what() << '\n';
    return 1;
  }
}
