#include "common/surface_graph/rift.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "common/surface_graph/view_graph.h"
#include "tests/common/surface_graph/scenes.h"

namespace thalweg::surface {
namespace {

using test::Rig;
using test::ViewOf;
using Vertex = SurfaceGraph::Vertex;
using Edge = SurfaceGraph::Edge;

/// Algorithm 2 word by word, with lists that are searched from end to end.
std::vector<std::set<Edge>> RiftsByDefinition(const SurfaceGraph& graph, double delta_m) {
  std::set<Edge> heavy;
  for (Edge edge = 0; edge < graph.edge_numbers(); ++edge) {
    if (graph.Exists(edge) && graph.Weight(edge) >= delta_m) heavy.insert(edge);
  }
  std::vector<std::set<Edge>> rifts;
  while (!heavy.empty()) {
    const Edge seed = *std::max_element(heavy.begin(), heavy.end(), [&](Edge a, Edge b) {
      return std::pair(graph.Weight(a), b) < std::pair(graph.Weight(b), a);
    });
    std::set<Edge> rift = {seed};
    std::vector<Edge> to_visit = {seed};
    while (!to_visit.empty()) {
      const Edge edge = to_visit.back();
      to_visit.pop_back();
      for (const int side : {0, 1}) {
        graph.ForEachEdge(graph.End(edge, side), [&](Edge, Vertex neighbor) {
          graph.ForEachEdge(neighbor, [&](Edge other, Vertex) {
            if (graph.Weight(other) > delta_m && rift.insert(other).second) to_visit.push_back(other);
          });
        });
      }
    }
    for (const Edge edge : rift) heavy.erase(edge);
    rifts.push_back(std::move(rift));
  }
  return rifts;
}

TEST(FindRifts, FindsWhatTheAlgorithmSaysOnRandomGraphs) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(0.0F, 1.0F);
  std::size_t found = 0;
  for (int trial = 0; trial < 100; ++trial) {
    SurfaceGraph graph;
    for (int i = 0; i < 60; ++i) graph.AddVertex({place(random), place(random), place(random)});
    for (int i = 0; i < 90; ++i) {
      const Vertex a = random() % 60;
      const Vertex b = random() % 60;
      if (a != b && !graph.AreNeighbors(a, b)) graph.AddEdge(a, b);
    }
    for (const double delta_m : {0.6, 0.8, 1.0}) {
      const std::vector<Rift> rifts = FindRifts(graph, delta_m);
      const std::vector<std::set<Edge>> expected = RiftsByDefinition(graph, delta_m);
      ASSERT_EQ(rifts.size(), expected.size());
      for (std::size_t i = 0; i < rifts.size(); ++i) {
        EXPECT_EQ(std::set<Edge>(rifts[i].edges.begin(), rifts[i].edges.end()), expected[i]);
        EXPECT_EQ(rifts[i].edges.size(), expected[i].size()) << "an edge stands twice";
      }
      found += rifts.size();
    }
  }
  EXPECT_GT(found, 500U);
}

TEST(FindRifts, TheRiftOfAStepIsOneAndWholeAndItsVertexIsInTheMiddle) {
  const StereoGeometry rig = Rig(100, 80, 70.0);
  const View view = ViewOf(rig, RigidTransform::Identity(), test::StepAt);
  ViewGraph part = GraphOf(view);
  std::vector<Rift> rifts = FindRifts(part.graph, 0.1);
  ASSERT_EQ(rifts.size(), 1U);
  EXPECT_EQ(rifts[0].edges.size(), 80U);  // one a row
  EXPECT_EQ(rifts[0].vertices.size(), 160U);
  for (const Edge edge : rifts[0].edges) {
    const float z_a = part.graph.Position(part.graph.End(edge, 0)).z();
    const float z_b = part.graph.Position(part.graph.End(edge, 1)).z();
    EXPECT_NEAR(std::min(z_a, z_b), 2.0, 1e-5);
    EXPECT_NEAR(std::max(z_a, z_b), 4.0, 1e-5);
  }
  // Between columns 49 and 50, half a pixel left and right of the optical axis: x = -0.5 / 70 * 2 and
  // 0.5 / 70 * 4.
  const Eigen::Vector3f middle(static_cast<float>(0.5 * (-1.0 + 2.0) / 70.0), 0.0F, 3.0F);
  EXPECT_NEAR((rifts[0].center_W - middle).norm(), 0.0, 1e-5);

  const std::size_t vertices = part.graph.vertex_count();
  AddRiftVertices(rifts, part.graph);
  EXPECT_EQ(rifts[0].vertex, vertices);
  EXPECT_EQ(part.graph.Position(rifts[0].vertex), rifts[0].center_W);
  for (const Vertex vertex : rifts[0].vertices) {
    EXPECT_TRUE(part.graph.AreNeighbors(rifts[0].vertex, vertex));
  }
}

TEST(FindRifts, SmoothSurfacesHaveNone) {
  const auto sphere_from_within = [](const Eigen::Vector3d&, const Eigen::Vector3d& ray_W) {
    return 2.0 / ray_W.norm();
  };
  const auto slope = [](const Eigen::Vector3d&, const Eigen::Vector3d& ray_W) {
    return 2.0 / (ray_W.z() + 0.8 * ray_W.x() + 0.4 * ray_W.y());
  };
  const auto corner = [](const Eigen::Vector3d&, const Eigen::Vector3d& ray_W) {
    return 3.0 / (ray_W.z() + std::abs(ray_W.x()));
  };
  const StereoGeometry rig = Rig(512, 384, 394.0);
  for (const View& view :
       {ViewOf(rig, RigidTransform::Identity(), sphere_from_within),
        ViewOf(rig, RigidTransform::Identity(), slope), ViewOf(rig, RigidTransform::Identity(), corner)}) {
    const ViewGraph part = GraphOf(view);
    ASSERT_EQ(part.graph.vertex_count(), 512U * 384U);
    EXPECT_TRUE(FindRifts(part.graph, 0.1).empty());
  }
}

TEST(FindRifts, ThingsApartHaveOneEachAroundTheirOutlines) {
  // Two squares, of 10 x 10 and 20 x 20 pixels, 1 m before a wall.
  View view{.rig = Rig(90, 50, 80.0), .disparities = std::vector<float>(90 * 50, 3.2F), .colors = {}};
  const auto fill = [&](int u0, int v0, int size) {
    for (int v = v0; v < v0 + size; ++v) {
      for (int u = u0; u < u0 + size; ++u) view.disparities[view.PixelAt(u, v)] = 4.8F;
    }
  };
  fill(10, 10, 10);
  fill(50, 15, 20);
  const std::vector<Rift> rifts = FindRifts(GraphOf(view).graph, 0.1);
  ASSERT_EQ(rifts.size(), 2U);
  const std::set<std::size_t> sizes = {rifts[0].edges.size(), rifts[1].edges.size()};
  EXPECT_EQ(sizes, (std::set<std::size_t>{40, 80}));
}

// As printed: an edge of exactly delta_m is in R_m, but joins no other's rift.
TEST(FindRifts, AnEdgeOfExactlyDeltaIsARiftOfItsOwn) {
  SurfaceGraph graph;
  for (const float x : {0.0F, 1.0F, 1.5F, 2.0F}) graph.AddVertex({x, 0.0F, 0.0F});
  graph.AddEdge(0, 1);  // 1
  graph.AddEdge(1, 2);  // 0.5
  graph.AddEdge(2, 3);  // 0.5
  EXPECT_EQ(FindRifts(graph, 0.5).size(), 3U);
  EXPECT_EQ(FindRifts(graph, 0.4).size(), 1U);
  EXPECT_EQ(FindRifts(graph, 0.6).size(), 1U);
}

}  // namespace
}  // namespace thalweg::surface
