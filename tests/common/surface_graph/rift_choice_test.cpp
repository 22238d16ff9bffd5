#include "common/surface_graph/rift_choice.h"

#include <gtest/gtest.h>

namespace thalweg::surface {
namespace {

/// A chain of points 0.05 m apart with a jump of 0.3 m and, further on, two of 0.2 m; and another jump that
/// is not connected with it.
SurfaceGraph Chain() {
  SurfaceGraph graph;
  float x = 0.0F;
  for (const float step : {0.0F, 0.05F, 0.3F, 0.05F, 0.05F, 0.05F, 0.2F, 0.2F}) {
    x += step;
    const auto vertex = graph.AddVertex({x, 0.0F, 0.0F});
    if (vertex > 0) graph.AddEdge(vertex - 1, vertex);
  }
  graph.AddEdge(graph.AddVertex({0.0F, 5.0F, 0.0F}), graph.AddVertex({0.0F, 9.0F, 0.0F}));
  return graph;
}

TEST(RankRifts, WeighsTheWayAndTheEdgesAsEquation511Does) {
  SurfaceGraph graph = Chain();
  std::vector<Rift> rifts = FindRifts(graph, 0.1);
  ASSERT_EQ(rifts.size(), 3U);
  ASSERT_EQ(rifts[1].edges.size(), 1U);
  ASSERT_EQ(rifts[2].edges.size(), 2U);
  AddRiftVertices(rifts, graph);
  // Rift vertices in the middle: at 0.2; at (0.5 + 0.7 + 0.9) / 3 = 0.7.
  const auto ranked = RankRifts(graph, rifts, 0, {.distance = 0.5, .edges = 0.5});
  ASSERT_EQ(ranked.size(), 2U) << "no path leads to the third";
  EXPECT_EQ(ranked[0].rift, 2U);
  EXPECT_NEAR(ranked[0].distance, 0.7, 1e-6);
  EXPECT_NEAR(ranked[0].weight, 0.5 * 0.7 + 0.5 * 2, 1e-6);
  EXPECT_EQ(ranked[1].rift, 1U);
  EXPECT_NEAR(ranked[1].weight, 0.5 * 0.2 + 0.5 * 1, 1e-6);
}

TEST(RankRifts, OnlyTheLengthCountsWhereEdgesHaveNoWeight) {
  SurfaceGraph graph = Chain();
  std::vector<Rift> rifts = FindRifts(graph, 0.1);
  AddRiftVertices(rifts, graph);
  const auto ranked = RankRifts(graph, rifts, 7, {.distance = 1.0, .edges = 0.0});
  ASSERT_EQ(ranked.size(), 2U);
  EXPECT_EQ(ranked[0].rift, 1U) << "as printed the farther one";
  EXPECT_NEAR(ranked[0].weight, 0.9 - 0.2, 1e-6);
}

}  // namespace
}  // namespace thalweg::surface
