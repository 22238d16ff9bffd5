#include "common/surface_graph/path_search.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>

namespace thalweg::surface {
namespace {

using Vertex = SurfaceGraph::Vertex;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Entry {
  double priority = 0.0;
  double estimate = 0.0;
  std::uint64_t order = 0;
  Vertex vertex = 0;
  bool operator>(const Entry& other) const {
    return std::tie(priority, estimate, order) > std::tie(other.priority, other.estimate, other.order);
  }
};

struct Tree {
  std::vector<double> lengths;
  std::vector<Vertex> parents;
  std::vector<Vertex> looked_at;
};

/// @param goal  kNone = none: everything is looked at.
/// @param estimate(vertex), priority(length, estimate)
template <class Estimate, class Priority>
Tree Search(const SurfaceGraph& graph, Vertex start, Vertex goal, bool improves, Estimate&& estimate,
            Priority&& priority) {
  Tree tree{std::vector<double>(graph.vertex_count(), kInfinity),
            std::vector<Vertex>(graph.vertex_count(), SurfaceGraph::kNone),
            {}};
  std::vector<std::uint8_t> done(graph.vertex_count(), 0);
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  std::uint64_t order = 0;
  const auto push = [&](Vertex vertex, double length, Vertex parent) {
    tree.lengths[vertex] = length;
    tree.parents[vertex] = parent;
    const double remaining = estimate(vertex);
    queue.push({priority(length, remaining), remaining, order++, vertex});
  };
  push(start, 0.0, SurfaceGraph::kNone);
  while (!queue.empty()) {
    const Vertex vertex = queue.top().vertex;
    queue.pop();
    if (done[vertex] != 0) continue;
    done[vertex] = 1;
    tree.looked_at.push_back(vertex);
    if (vertex == goal) break;
    graph.ForEachEdge(vertex, [&](SurfaceGraph::Edge edge, Vertex neighbor) {
      if (done[neighbor] != 0) return;
      const double length = tree.lengths[vertex] + graph.Weight(edge);
      if (improves ? length < tree.lengths[neighbor] : tree.lengths[neighbor] == kInfinity) {
        push(neighbor, length, vertex);
      }
    });
  }
  return tree;
}

}  // namespace

FoundPath FindPath(const SurfaceGraph& graph, Vertex start, Vertex goal, SearchMethod method,
                   Heuristic heuristic) {
  const Eigen::Vector3d p_goal = graph.Position(goal).cast<double>();
  const auto estimate = [&](Vertex vertex) {
    const Eigen::Vector3d d = graph.Position(vertex).cast<double>() - p_goal;
    return heuristic == Heuristic::kManhattan ? d.lpNorm<1>() : d.norm();
  };
  const auto priority = [method](double length, double remaining) {
    if (method == SearchMethod::kDijkstra) return length;
    return method == SearchMethod::kBestFirst ? remaining : length + remaining;
  };
  Tree tree = Search(graph, start, goal, method != SearchMethod::kBestFirst, estimate, priority);
  FoundPath path;
  path.looked_at = std::move(tree.looked_at);
  if (tree.lengths[goal] == kInfinity) return path;
  path.length = tree.lengths[goal];
  for (Vertex vertex = goal; vertex != SurfaceGraph::kNone; vertex = tree.parents[vertex]) {
    path.vertices.push_back(vertex);
  }
  std::reverse(path.vertices.begin(), path.vertices.end());
  return path;
}

std::vector<double> LengthsFrom(const SurfaceGraph& graph, Vertex start) {
  const auto nothing = [](Vertex) { return 0.0; };
  const auto length_first = [](double length, double) { return length; };
  return Search(graph, start, SurfaceGraph::kNone, true, nothing, length_first).lengths;
}

}  // namespace thalweg::surface
