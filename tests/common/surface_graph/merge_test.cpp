#include "common/surface_graph/merge.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "tests/common/surface_graph/scenes.h"

namespace thalweg::surface {
namespace {

using test::Rig;
using Vertex = SurfaceGraph::Vertex;

/// The graph of two views, and what became of the second one.
struct Both {
  SurfaceGraph graph;
  MergedView first;
  Merging second;
};

Both MergeBoth(const View& a, const View& b, double gamma) {
  Both both;
  const Merging merging = Merge(GraphOf(a), a, nullptr, gamma, both.graph);
  both.first = {a, merging.vertex_of_pixel};
  both.second = Merge(GraphOf(b), b, &both.first, gamma, both.graph);
  return both;
}

TEST(Merge, OfAViewWithItselfAddsNothing) {
  const View view = test::ViewOf(Rig(60, 40, 50.0), RigidTransform::Identity(), test::StepAt);
  const ViewGraph alone = GraphOf(view);
  const Both both = MergeBoth(view, view, 0.01);
  EXPECT_EQ(both.second.added, 0U);
  EXPECT_EQ(both.second.dropped, 60U * 40U);
  EXPECT_EQ(both.second.vertex_of_pixel, both.first.vertex_of_pixel);
  EXPECT_EQ(both.graph.vertex_count(), alone.graph.vertex_count());
  EXPECT_EQ(both.graph.edge_count(), alone.graph.edge_count());
}

TEST(Merge, OfTwoViewsOfOnePlaneHasTheVerticesAndEdgesOfOneWiderView) {
  constexpr int kShift = 17;
  const auto [a, b] = test::PlaneTwice(Rig(60, 40, 50.0), 2.0, kShift);
  const Both both = MergeBoth(a, b, 0.01);
  constexpr std::size_t kWidth = 60 + kShift;
  EXPECT_EQ(both.second.added, 40U * kShift);
  EXPECT_EQ(both.graph.vertex_count(), kWidth * 40U);
  EXPECT_EQ(both.graph.edge_count(), (kWidth - 1) * 40U + kWidth * 39U);
}

TEST(Merge, PointsThatAreFartherApartThanGammaStayTwo) {
  const StereoGeometry rig = Rig(60, 40, 50.0);
  const auto wall_at = [](double z) {
    return [z](const Eigen::Vector3d& o, const Eigen::Vector3d& r) { return test::PlaneAt(z, o, r); };
  };
  const View a = test::ViewOf(rig, RigidTransform::Identity(), wall_at(2.0));
  EXPECT_EQ(MergeBoth(a, test::ViewOf(rig, RigidTransform::Identity(), wall_at(2.02)), 0.01).second.dropped,
            0U);
  // At the principal point the walls are 6 mm apart, at the corners, 36 degrees off, 7.4 mm.
  EXPECT_EQ(MergeBoth(a, test::ViewOf(rig, RigidTransform::Identity(), wall_at(2.006)), 0.01).second.added,
            0U);
}

/// Algorithm 3 by looking for each vertex at every pixel of the other view.
TEST(Merge, CountsWhatTheAlgorithmSaysForNoisyViewsFromRandomPlaces) {
  std::mt19937 random(6);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::uniform_real_distribution<double> near_zero(-0.1, 0.1);
  const StereoGeometry rig = Rig(40, 30, 36.0);
  std::size_t dropped = 0;
  std::size_t added = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const auto noisy_step = [&](const Eigen::Vector3d& o, const Eigen::Vector3d& r) {
      return random() % 10 == 0 ? test::kNothing : test::StepAt(o, r) + noise(random);
    };
    const auto pose = [&]() -> RigidTransform {
      const Eigen::AngleAxisd turn(near_zero(random), Eigen::Vector3d::UnitY());
      return MakeTransform(turn.toRotationMatrix(),
                           {near_zero(random), near_zero(random), near_zero(random)});
    };
    const View a = test::ViewOf(rig, pose(), noisy_step);
    const View b = test::ViewOf(rig, pose(), noisy_step);
    const double gamma = 0.03;
    const Both both = MergeBoth(a, b, gamma);

    const ViewGraph part_a = GraphOf(a);
    std::vector<Vertex> expected(b.disparities.size(), SurfaceGraph::kNone);
    auto next = static_cast<Vertex>(part_a.graph.vertex_count());
    for (std::size_t pixel = 0; pixel < expected.size(); ++pixel) {
      if (!b.IsValid(pixel)) continue;
      const Eigen::Vector3d p_W = (b.T_WC * b.PointAt(pixel)).cast<float>().cast<double>();
      const Eigen::Vector3d p_C = a.T_WC.inverse() * p_W;
      for (int v = 0; v < 30; ++v) {
        for (int u = 0; u < 40; ++u) {
          const bool shows = std::abs(rig.camera.fx * p_C.x() / p_C.z() + rig.camera.cx - u) <= 0.5 &&
                             std::abs(rig.camera.fy * p_C.y() / p_C.z() + rig.camera.cy - v) <= 0.5;
          const std::size_t other = a.PixelAt(u, v);
          if (!shows || !a.IsValid(other)) continue;
          if ((a.T_WC * a.PointAt(other) - p_W).norm() < gamma)
            expected[pixel] = part_a.vertex_of_pixel[other];
        }
      }
      if (expected[pixel] == SurfaceGraph::kNone) expected[pixel] = next++;
    }
    EXPECT_EQ(both.second.vertex_of_pixel, expected);
    EXPECT_EQ(both.graph.vertex_count(), next);

    std::set<std::pair<Vertex, Vertex>> edges;
    const auto add_edges = [&](const std::vector<Vertex>& vertex_of_pixel) {
      for (int v = 0; v < 30; ++v) {
        for (int u = 0; u < 40; ++u) {
          for (const auto& [u2, v2] : {std::pair(u + 1, v), std::pair(u, v + 1)}) {
            if (u2 >= 40 || v2 >= 30) continue;
            const Vertex p = vertex_of_pixel[a.PixelAt(u, v)];
            const Vertex q = vertex_of_pixel[a.PixelAt(u2, v2)];
            if (p == SurfaceGraph::kNone || q == SurfaceGraph::kNone || p == q) continue;
            edges.insert(std::minmax(p, q));
          }
        }
      }
    };
    add_edges(part_a.vertex_of_pixel);
    add_edges(expected);
    EXPECT_EQ(both.graph.edge_count(), edges.size());
    for (const auto& [p, q] : edges) EXPECT_TRUE(both.graph.AreNeighbors(p, q));
    dropped += both.second.dropped;
    added += both.second.added;
  }
  EXPECT_GT(dropped, 1000U);
  EXPECT_GT(added, 1000U);
}

}  // namespace
}  // namespace thalweg::surface
