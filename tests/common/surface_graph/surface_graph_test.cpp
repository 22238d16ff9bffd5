#include "common/surface_graph/surface_graph.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

namespace thalweg::surface {
namespace {

using Vertex = SurfaceGraph::Vertex;
using Edge = SurfaceGraph::Edge;

/// The same graph as sets.
struct Reference {
  std::map<Edge, std::pair<Vertex, Vertex>> edges;

  std::multiset<std::pair<Edge, Vertex>> EdgesOf(Vertex vertex) const {
    std::multiset<std::pair<Edge, Vertex>> result;
    for (const auto& [edge, ends] : edges) {
      if (ends.first == vertex) result.emplace(edge, ends.second);
      if (ends.second == vertex) result.emplace(edge, ends.first);
    }
    return result;
  }
};

void ExpectSame(const SurfaceGraph& graph, const Reference& reference) {
  ASSERT_EQ(graph.edge_count(), reference.edges.size());
  for (Vertex vertex = 0; vertex < graph.vertex_count(); ++vertex) {
    std::multiset<std::pair<Edge, Vertex>> edges;
    graph.ForEachEdge(vertex, [&](Edge edge, Vertex neighbor) {
      edges.emplace(edge, neighbor);
      EXPECT_TRUE(graph.AreNeighbors(vertex, neighbor));
    });
    EXPECT_EQ(edges, reference.EdgesOf(vertex)) << vertex;
  }
}

TEST(SurfaceGraph, KeepsTheEdgesOfEachVertexAsSetsDo) {
  std::mt19937 random(1);
  SurfaceGraph graph;
  Reference reference;
  for (int i = 0; i < 40; ++i) graph.AddVertex(Eigen::Vector3f(static_cast<float>(i), 0, 0));
  for (int step = 0; step < 2000; ++step) {
    const Vertex a = random() % 40;
    const Vertex b = random() % 40;
    if (reference.edges.size() < 100 && a != b) {
      const Edge edge = graph.AddEdge(a, b);
      EXPECT_EQ(graph.Weight(edge), std::abs(static_cast<float>(a) - static_cast<float>(b)));
      reference.edges[edge] = {a, b};
    } else if (!reference.edges.empty()) {
      const auto removed =
          std::next(reference.edges.begin(), static_cast<std::ptrdiff_t>(random() % reference.edges.size()));
      EXPECT_TRUE(graph.Exists(removed->first));
      graph.RemoveEdge(removed->first);
      EXPECT_FALSE(graph.Exists(removed->first));
      reference.edges.erase(removed);
    }
  }
  ExpectSame(graph, reference);
}

TEST(SurfaceGraph, WhatWasAddedLastCanBeTakenBack) {
  SurfaceGraph graph;
  Reference reference;
  for (int i = 0; i < 5; ++i) graph.AddVertex(Eigen::Vector3f::Zero());
  reference.edges[graph.AddEdge(0, 1)] = {0, 1};
  reference.edges[graph.AddEdge(2, 1)] = {2, 1};
  const Vertex hub = graph.AddVertex(Eigen::Vector3f::Ones());
  for (Vertex vertex = 0; vertex < 5; ++vertex) graph.AddEdge(hub, vertex);
  graph.TruncateTo(5, 2);
  EXPECT_EQ(graph.vertex_count(), 5U);
  EXPECT_EQ(graph.edge_numbers(), 2U);
  ExpectSame(graph, reference);
}

}  // namespace
}  // namespace thalweg::surface
