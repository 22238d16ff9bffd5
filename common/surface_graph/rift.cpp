#include "common/surface_graph/rift.h"

#include <algorithm>
#include <utility>

namespace thalweg::surface {
namespace {

using Vertex = SurfaceGraph::Vertex;
using Edge = SurfaceGraph::Edge;

/// Grows rifts from seeds. What one rift has taken, no later one can reach.
class Growth {
 public:
  Growth(const SurfaceGraph& graph, double delta_m)
      : graph_(graph),
        delta_m_(delta_m),
        taken_(graph.edge_numbers(), 0),
        expanded_(graph.vertex_count(), 0),
        searched_(graph.vertex_count(), 0) {}

  bool IsTaken(Edge edge) const { return taken_[edge] != 0; }

  std::vector<Edge> From(Edge seed) {
    taken_[seed] = 1;
    std::vector<Edge> edges = {seed};  // also the list ToVisit: what stands behind `next` is yet to be popped
    for (std::size_t next = 0; next < edges.size(); ++next) {
      const Edge edge = edges[next];
      for (const int side : {0, 1}) Expand(graph_.End(edge, side), edges);
    }
    return edges;
  }

 private:
  void Expand(Vertex end, std::vector<Edge>& edges) {
    if (expanded_[end] != 0) return;
    expanded_[end] = 1;
    graph_.ForEachEdge(end, [&](Edge, Vertex neighbor) {
      if (searched_[neighbor] != 0) return;
      searched_[neighbor] = 1;
      graph_.ForEachEdge(neighbor, [&](Edge edge, Vertex) {
        if (taken_[edge] != 0 || !(graph_.Weight(edge) > delta_m_)) return;
        taken_[edge] = 1;
        edges.push_back(edge);
      });
    });
  }

  const SurfaceGraph& graph_;
  double delta_m_;
  std::vector<std::uint8_t> taken_;     ///< By edge: belongs to a rift.
  std::vector<std::uint8_t> expanded_;  ///< By vertex: its neighbors were searched.
  std::vector<std::uint8_t> searched_;  ///< By vertex: its heavy edges are taken.
};

}  // namespace

std::vector<Rift> FindRifts(const SurfaceGraph& graph, double delta_m) {
  std::vector<std::pair<float, Edge>> heavy;
  for (Edge edge = 0; edge < graph.edge_numbers(); ++edge) {
    if (graph.Exists(edge) && graph.Weight(edge) >= delta_m) heavy.emplace_back(-graph.Weight(edge), edge);
  }
  std::sort(heavy.begin(), heavy.end());
  Growth growth(graph, delta_m);
  std::vector<std::size_t> last_rift_of(graph.vertex_count(), 0);  // by vertex, from 1
  std::vector<Rift> rifts;
  for (const auto& [weight, seed] : heavy) {
    if (growth.IsTaken(seed)) continue;
    Rift& rift = rifts.emplace_back();
    rift.edges = growth.From(seed);
    Eigen::Vector3d sum_W = Eigen::Vector3d::Zero();
    for (const Edge edge : rift.edges) {
      for (const int side : {0, 1}) {
        const Vertex vertex = graph.End(edge, side);
        if (std::exchange(last_rift_of[vertex], rifts.size()) == rifts.size()) continue;
        rift.vertices.push_back(vertex);
        sum_W += graph.Position(vertex).cast<double>();
      }
    }
    rift.center_W = (sum_W / static_cast<double>(rift.vertices.size())).cast<float>();
  }
  return rifts;
}

void AddRiftVertices(std::vector<Rift>& rifts, SurfaceGraph& graph) {
  for (Rift& rift : rifts) {
    rift.vertex = graph.AddVertex(rift.center_W);
    for (const Vertex vertex : rift.vertices) graph.AddEdge(rift.vertex, vertex);
  }
}

}  // namespace thalweg::surface
