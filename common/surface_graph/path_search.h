#pragma once

#include <cstdint>
#include <vector>

#include "common/surface_graph/surface_graph.h"

namespace thalweg::surface {

/// How the next vertex is chosen among those that are known but not yet looked at.
enum class SearchMethod : std::uint8_t {
  kDijkstra,   ///< The least length d from the start [Dijkstra 1959].
  kBestFirst,  ///< The least estimate h to the goal, whatever the path to it: greedy best-first.
  kAStar,      ///< The least f = d + h [Hart, Nilsson, Raphael 1968].
};

/// The estimate h of the length that remains.
enum class Heuristic : std::uint8_t {
  kStraightLine,  ///< |p - goal|, which never overestimates.
  kManhattan,     ///< |dx| + |dy| + |dz|, Eq. (5.18): never too long on a grid whose edges follow the axes.
};

struct FoundPath {
  std::vector<SurfaceGraph::Vertex> vertices;   ///< From the start to the goal; empty if there is no path.
  double length = 0.0;                          ///< [m] Sum of the weights.
  std::vector<SurfaceGraph::Vertex> looked_at;  ///< What was taken from the queue, in order, each once.
};

/// A path over the surface, as in Chapter 5 of the source thesis. Among equal priorities that with the
/// least estimate goes first, then that which was reached first. O(edges * log).
FoundPath FindPath(const SurfaceGraph& graph, SurfaceGraph::Vertex start, SurfaceGraph::Vertex goal,
                   SearchMethod method, Heuristic heuristic = Heuristic::kStraightLine);

/// [m] Length of the shortest path from the start to each vertex, infinity where there is none.
std::vector<double> LengthsFrom(const SurfaceGraph& graph, SurfaceGraph::Vertex start);

}  // namespace thalweg::surface
