// Cost and memory of both engines of the map: random views of each scenario's world, fused by each. "as
// octomap" is the blocks without our rules and with OctoMap's rays, on the same clouds.
#include <octomap/OcTree.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "common/base/stopwatch.h"
#include "services/evaluator/adapter/scene.h"
#include "services/mapper/core/map_engine.h"
#include "services/mapper/core/octree_map.h"
#include "services/simulator/core/depth_sensor.h"

namespace thalweg {
namespace {

struct View {
  PointCloud cloud;
  RigidTransform T_WC;
};

std::vector<View> ViewsOf(const evaluator::Scene& scene, int count) {
  const evaluator::LockstepOptions options = scene.Options("", 1);
  simulator::DepthSensor sensor(options.sensor, 1, /*colors=*/false);
  std::vector<View> views;
  for (int view = 1; view <= count; ++view) {
    // Level views would never see the ceiling.
    RigidTransform T_WB = scene.Start(view);
    T_WB.linear() *= RotationFromYawPitch(0.0, 0.5 * (view % 5 - 2));
    const RigidTransform T_WC = T_WB * options.robot.T_BC;
    views.push_back({sensor.Capture(scene.world(), T_WC), T_WC});
  }
  return views;
}

struct Figures {
  double median_ms = 0.0;    ///< Median time of a scan.
  double p95_ms = 0.0;       ///< Likewise.
  double snapshot_ms = 0.0;  ///< Time for a copy of the whole map, as for a checkpoint.
  std::size_t known = 0;     ///< Voxels.
};

Figures Fuse(mapper::FusedMap& map, const std::vector<View>& views) {
  std::vector<double> spent_ms;
  for (const View& view : views) {
    const Stopwatch watch;
    map.Integrate(view.cloud, view.T_WC);
    spent_ms.push_back(watch.Milliseconds());
  }
  std::ranges::sort(spent_ms);
  Figures figures;
  figures.median_ms = spent_ms[spent_ms.size() / 2];
  figures.p95_ms = spent_ms[spent_ms.size() * 95 / 100];
  const Stopwatch watch;
  const OccupancyGrid grid = map.Snapshot();
  figures.snapshot_ms = watch.Milliseconds();
  grid.ForEachKnown([&](const VoxelIndex&, float) { ++figures.known; });
  return figures;
}

void Print(const char* engine, const Figures& figures, std::size_t bytes) {
  std::printf("  %-11s %8.2f %8.2f %10.1f %9zu %9.2f %13.1f\n", engine, figures.median_ms, figures.p95_ms,
              figures.snapshot_ms, figures.known, 1e-6 * static_cast<double>(bytes),
              static_cast<double>(bytes) / static_cast<double>(figures.known));
}

std::size_t BytesOf(const OccupancyGrid& grid) {
  return grid.block_count() * sizeof(OccupancyGrid::Block);
}

void Compare(const std::string& name, int count, const std::vector<std::string>& overrides) {
  const evaluator::Scene scene(name, overrides);
  const std::vector<View> views = ViewsOf(scene, count);
  mapper::OccupancyMap::Options options = scene.Options("", 1).mapper;
  std::printf("%s\n", name.c_str());
  mapper::OccupancyMap blocks(options);
  const Figures of_blocks = Fuse(blocks, views);
  Print("BLOCKS", of_blocks, BytesOf(blocks.grid()));
  options.protect = options.fill = false;
  options.shadow = 0.0;
  mapper::OccupancyMap plain(options);
  const Figures of_plain = Fuse(plain, views);
  Print("as octomap", of_plain, BytesOf(plain.grid()));
  mapper::OctreeMap octree(options);
  const Figures of_octree = Fuse(octree, views);
  Print("OCTOMAP", of_octree, octree.tree().memoryUsage());
  std::printf("  tree: %zu leaves of %zu nodes\n", octree.tree().getNumLeafNodes(), octree.tree().size());
}

int Main(int argc, char** argv) {
  std::vector<std::string> names = {"kitchen"};
  int views = 200;
  std::vector<std::string> overrides;
  CLI::App app("Cost and memory of mapper.engine BLOCKS and OCTOMAP.");
  app.add_option("scenarios", names)->capture_default_str();
  app.add_option("--views", views)->capture_default_str()->check(CLI::Range(1, 100000));
  app.add_option("--set", overrides, "PATH=VALUE");
  CLI11_PARSE(app, argc, argv);
  std::printf("              ms scan      p95  ms snapshot     known        MB  bytes a voxel\n");
  for (const std::string& name : names) Compare(name, views, overrides);
  return 0;
}

}  // namespace
}  // namespace thalweg

int main(int argc, char** argv) {
  try {
    return thalweg::Main(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "bench_mapper_engines: " << error.what() << '\n';
    return 1;
  }
}
