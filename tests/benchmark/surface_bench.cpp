#include <benchmark/benchmark.h>

#include <random>

#include "common/surface_graph/edge_visibility.h"
#include "common/surface_graph/merge.h"
#include "common/surface_graph/rift.h"
#include "common/surface_graph/surface.h"
#include "tests/support/analytic_room.h"

namespace thalweg::surface {
namespace {

constexpr double kRiftEdge = SurfaceOptions{}.rift_edge;
constexpr double kMergeDistance = SurfaceOptions{}.merge_distance;
constexpr std::size_t kMillion = 1'000'000;

/// 512 x 384 disparities of a furnished room, off by 0.1 px.
View ViewFrom(const RigidTransform& T_WC, std::mt19937& random) {
  const StereoGeometry rig{PinholeCamera::FromFieldOfView(512, 384, 1.15), 0.12};
  const auto room = thalweg::test::AnalyticRoom::Furnished();
  const PointCloud cloud = room.Render(rig.camera, T_WC);
  DepthImage depth{cloud.width_px, cloud.height_px, {}};
  for (const Eigen::Vector3f& p_C : cloud.points_C) depth.depths.push_back(p_C.z());
  std::normal_distribution<float> noise(0.0F, 0.1F);
  View view{.rig = rig, .disparities = DisparitiesOf(depth, rig), .colors = {}, .T_WC = T_WC};
  for (float& disparity : view.disparities) disparity += noise(random);
  return view;
}

/// A graph of a million vertices, the last view in it, and one 5 cm beside that.
struct Scene {
  Scene() {
    const auto room = thalweg::test::AnalyticRoom::Furnished();
    for (bool is_first = true; graph.vertex_count() < kMillion; is_first = false) {
      View view = ViewFrom(room.RandomPose(random), random);
      Merging merging = Merge(GraphOf(view), view, is_first ? nullptr : &last, kMergeDistance, graph);
      last = {std::move(view), std::move(merging.vertex_of_pixel)};
    }
    next = ViewFrom(last.view.T_WC * Eigen::Translation3d(0.05, 0.0, 0.0), random);
    part = GraphOf(next);
  }
  std::mt19937 random{1};
  SurfaceGraph graph;
  MergedView last;
  View next;
  ViewGraph part;
};

/// Across the room, with all of its furniture in sight.
RigidTransform FromTheCorner() {
  return MakeTransform(RotationFromYawPitch(0.6, -0.1) * BodyFromOptical(), {-3.7, -2.7, 0.8});
}

void GraphAndRiftsOfAView(benchmark::State& state) {
  std::mt19937 random(1);
  const View view = ViewFrom(FromTheCorner(), random);
  for (auto _ : state) {
    const ViewGraph part = GraphOf(view);
    const std::vector<Rift> rifts = FindRifts(part.graph, kRiftEdge);
    state.counters["vertices"] = static_cast<double>(part.graph.vertex_count());
    state.counters["rifts"] = static_cast<double>(rifts.size());
  }
}
BENCHMARK(GraphAndRiftsOfAView)->Unit(benchmark::kMillisecond);

void MergeIntoAMillionVertices(benchmark::State& state) {
  Scene scene;
  const std::size_t vertices = scene.graph.vertex_count();
  const std::size_t edges = scene.graph.edge_numbers();
  for (auto _ : state) {
    const Merging merging = Merge(scene.part, scene.next, &scene.last, kMergeDistance, scene.graph);
    state.counters["dropped"] = static_cast<double>(merging.dropped);
    state.counters["added"] = static_cast<double>(merging.added);
    state.PauseTiming();
    scene.graph.TruncateTo(vertices, edges);
    state.ResumeTiming();
  }
}
BENCHMARK(MergeIntoAMillionVertices)->Unit(benchmark::kMillisecond);

/// All edges of the graph against a new image. Nothing is deleted, so that each round does the same work.
void VisibilityOfAMillionVertices(benchmark::State& state) {
  Scene scene;
  const EdgeVisibilityOptions never{.share = 1.0, .margin = kMergeDistance};
  for (auto _ : state) {
    benchmark::DoNotOptimize(DeleteEdgesSeenThrough(scene.next, kRiftEdge, 0, never, scene.graph));
  }
  std::size_t heavy = 0;
  for (SurfaceGraph::Edge edge = 0; edge < scene.graph.edge_numbers(); ++edge) {
    if (scene.graph.Weight(edge) >= kRiftEdge) ++heavy;
  }
  state.counters["tested"] = static_cast<double>(heavy);
}
BENCHMARK(VisibilityOfAMillionVertices)->Unit(benchmark::kMillisecond);

void RiftsOfAMillionVertices(benchmark::State& state) {
  const Scene scene;
  for (auto _ : state) benchmark::DoNotOptimize(FindRifts(scene.graph, kRiftEdge));
}
BENCHMARK(RiftsOfAMillionVertices)->Unit(benchmark::kMillisecond);

/// Time by pixels, for its growth: square images.
void GraphAndRiftsBySize(benchmark::State& state) {
  const auto size = static_cast<int>(state.range(0));
  const StereoGeometry rig{PinholeCamera::FromFieldOfView(size, size, 1.15), 0.12};
  const RigidTransform T_WC = FromTheCorner();
  const PointCloud cloud = thalweg::test::AnalyticRoom::Furnished().Render(rig.camera, T_WC);
  DepthImage depth{size, size, {}};
  for (const Eigen::Vector3f& p_C : cloud.points_C) depth.depths.push_back(p_C.z());
  const View view{.rig = rig, .disparities = DisparitiesOf(depth, rig), .colors = {}, .T_WC = T_WC};
  for (auto _ : state) benchmark::DoNotOptimize(FindRifts(GraphOf(view).graph, kRiftEdge));
  state.SetComplexityN(state.range(0) * state.range(0));
}
BENCHMARK(GraphAndRiftsBySize)
    ->RangeMultiplier(2)
    ->Range(128, 1024)
    ->Unit(benchmark::kMillisecond)
    ->Complexity(benchmark::oN);

}  // namespace
}  // namespace thalweg::surface
