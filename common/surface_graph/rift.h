#pragma once

#include <vector>

#include "common/surface_graph/surface_graph.h"

namespace thalweg::surface {

/// A place where the surface is torn: heavy edges close together.
struct Rift {
  std::vector<SurfaceGraph::Edge> edges;       ///< The seed first.
  std::vector<SurfaceGraph::Vertex> vertices;  ///< The ends of the edges, each once.
  Eigen::Vector3f center_W = Eigen::Vector3f::Zero();
  SurfaceGraph::Vertex vertex = SurfaceGraph::kNone;  ///< The rift vertex, once it is in the graph.
};

/// Algorithm 2 of the source thesis: R_m = {e : w(e) >= delta_m}. The heaviest edge of R_m is a rift's seed;
/// an edge with w > delta_m joins the rift if one of its ends is a neighbor of an end of one of the rift's
/// edges. The rift's edges leave R_m, until R_m is empty: no rift means that the exploration is over.
///
/// Departures: the "geometric mean of the vertices", where the rift vertex stands, is taken to be their
/// centroid, since coordinates may be negative. Each vertex is expanded once, which finds the same rifts in
/// O(edges + heavy edges * log).
/// @param delta_m  [m]
/// @return  Ordered by their seeds, heaviest first.
std::vector<Rift> FindRifts(const SurfaceGraph& graph, double delta_m);

/// Adds a rift vertex for each rift at its center, joined to all of its vertices.
void AddRiftVertices(std::vector<Rift>& rifts, SurfaceGraph& graph);

}  // namespace thalweg::surface
