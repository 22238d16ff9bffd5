#include "common/surface_graph/path_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace thalweg::surface {
namespace {

using Vertex = SurfaceGraph::Vertex;
using Edge = SurfaceGraph::Edge;

/// Points in a box of 3 m; those within 0.45 m of each other are mostly joined.
SurfaceGraph RandomGraph(std::mt19937& random, int vertices) {
  std::uniform_real_distribution<float> place(0.0F, 3.0F);
  SurfaceGraph graph;
  for (int i = 0; i < vertices; ++i) graph.AddVertex({place(random), place(random), 0.3F * place(random)});
  for (Vertex a = 0; a < graph.vertex_count(); ++a) {
    for (Vertex b = 0; b < a; ++b) {
      const bool near = (graph.Position(a) - graph.Position(b)).norm() < 0.45F;
      if (near && random() % 5 != 0) graph.AddEdge(a, b);
    }
  }
  return graph;
}

/// n x n points at whole meters, joined to their four neighbors.
SurfaceGraph Grid(int n) {
  SurfaceGraph graph;
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const Vertex vertex = graph.AddVertex({static_cast<float>(x), static_cast<float>(y), 0.0F});
      if (x > 0) graph.AddEdge(vertex - 1, vertex);
      if (y > 0) graph.AddEdge(vertex - static_cast<Vertex>(n), vertex);
    }
  }
  return graph;
}

/// The sum of the weights along a path whose vertices must be neighbors.
double LengthOf(const SurfaceGraph& graph, const std::vector<Vertex>& path) {
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    EXPECT_TRUE(graph.AreNeighbors(path[i - 1], path[i]));
    length += (graph.Position(path[i - 1]) - graph.Position(path[i])).norm();
  }
  return length;
}

/// Bellman and Ford's relaxation until nothing changes.
std::vector<double> LengthsByRelaxation(const SurfaceGraph& graph, Vertex start) {
  std::vector<double> lengths(graph.vertex_count(), std::numeric_limits<double>::infinity());
  lengths.at(start) = 0.0;
  for (bool changed = true; changed;) {
    changed = false;
    for (Edge edge = 0; edge < graph.edge_numbers(); ++edge) {
      for (const int side : {0, 1}) {
        const double length = lengths[graph.End(edge, side)] + graph.Weight(edge);
        double& other = lengths[graph.End(edge, 1 - side)];
        if (length < other - 1e-12) {
          other = length;
          changed = true;
        }
      }
    }
  }
  return lengths;
}

TEST(FindPath, AStarFindsDijkstrasLengthAndLooksAtFewerVerticesOnAThousandRandomGraphs) {
  std::mt19937 random(4);
  std::size_t looked_at_dijkstra = 0;
  std::size_t looked_at_a_star = 0;
  int found = 0;
  int fewer = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const SurfaceGraph graph = RandomGraph(random, 250);
    const Vertex start = random() % 250;
    const Vertex goal = random() % 250;
    const FoundPath dijkstra = FindPath(graph, start, goal, SearchMethod::kDijkstra);
    const FoundPath a_star = FindPath(graph, start, goal, SearchMethod::kAStar);
    const FoundPath best_first = FindPath(graph, start, goal, SearchMethod::kBestFirst);
    ASSERT_EQ(dijkstra.vertices.empty(), a_star.vertices.empty());
    ASSERT_EQ(dijkstra.vertices.empty(), best_first.vertices.empty());
    if (dijkstra.vertices.empty()) {
      EXPECT_EQ(dijkstra.looked_at.size(), a_star.looked_at.size())
          << "each looks at all that the start reaches";
      continue;
    }
    ++found;
    EXPECT_NEAR(a_star.length, dijkstra.length, 1e-9);
    EXPECT_LE(a_star.looked_at.size(), dijkstra.looked_at.size());
    EXPECT_GE(best_first.length, dijkstra.length - 1e-9);
    if (a_star.looked_at.size() < dijkstra.looked_at.size()) ++fewer;
    looked_at_dijkstra += dijkstra.looked_at.size();
    looked_at_a_star += a_star.looked_at.size();
    for (const FoundPath* path : {&dijkstra, &a_star, &best_first}) {
      EXPECT_EQ(path->vertices.front(), start);
      EXPECT_EQ(path->vertices.back(), goal);
      EXPECT_NEAR(LengthOf(graph, path->vertices), path->length, 1e-5);
    }
  }
  EXPECT_GT(found, 900);
  EXPECT_GT(fewer, 0.9 * found);
  EXPECT_LT(2 * looked_at_a_star, looked_at_dijkstra);
}

TEST(FindPath, LengthsAreThoseOfRelaxation) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 30; ++trial) {
    const SurfaceGraph graph = RandomGraph(random, 120);
    const std::vector<double> expected = LengthsByRelaxation(graph, 7);
    const std::vector<double> lengths = LengthsFrom(graph, 7);
    for (Vertex goal = 0; goal < graph.vertex_count(); ++goal) {
      if (std::isinf(expected[goal])) {
        EXPECT_TRUE(std::isinf(lengths[goal]));
        EXPECT_TRUE(FindPath(graph, 7, goal, SearchMethod::kAStar).vertices.empty());
        continue;
      }
      EXPECT_NEAR(lengths[goal], expected[goal], 1e-9);
      EXPECT_NEAR(FindPath(graph, 7, goal, SearchMethod::kDijkstra).length, expected[goal], 1e-9);
    }
  }
}

TEST(FindPath, OnAFreeGridTheManhattanEstimateIsExactAndOnlyThePathIsLookedAt) {
  const SurfaceGraph graph = Grid(30);
  for (const SearchMethod method : {SearchMethod::kAStar, SearchMethod::kBestFirst}) {
    const FoundPath path = FindPath(graph, 0, 30 * 30 - 1, method, Heuristic::kManhattan);
    EXPECT_EQ(path.length, 58.0);
    EXPECT_EQ(path.looked_at.size(), 59U);
  }
  const FoundPath dijkstra = FindPath(graph, 0, 30 * 30 - 1, SearchMethod::kDijkstra);
  EXPECT_EQ(dijkstra.length, 58.0);
  EXPECT_EQ(dijkstra.looked_at.size(), 900U);
}

TEST(FindPath, FromAVertexToItselfIsThatVertex) {
  const SurfaceGraph graph = Grid(3);
  const FoundPath path = FindPath(graph, 4, 4, SearchMethod::kAStar);
  EXPECT_EQ(path.vertices, std::vector<Vertex>{4});
  EXPECT_EQ(path.length, 0.0);
}

}  // namespace
}  // namespace thalweg::surface
