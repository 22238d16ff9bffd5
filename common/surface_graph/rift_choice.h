#pragma once

#include <vector>

#include "common/surface_graph/rift.h"

namespace thalweg::surface {

/// alpha and beta of Eq. (5.11).
struct RiftWeights {
  double distance = 0.5;  ///< [1/m]
  double edges = 0.5;     ///< Per edge.
};

struct RankedRift {
  std::size_t rift = 0;   ///< Index.
  double distance = 0.0;  ///< [m] Through the graph, from the camera's vertex to the rift vertex.
  double weight = 0.0;
};

/// Ranks the rifts by weight(R) = alpha dist(R) + beta edges(R), Eq. (5.11), where edges(R) is the number of
/// its edges, the heaviest first: that is the dominant rift. As printed, a farther rift weighs more. Rifts
/// that no path leads to are left out.
/// @param rifts          With their rift vertices in the graph.
/// @param camera_vertex  What the camera looks at.
std::vector<RankedRift> RankRifts(const SurfaceGraph& graph, const std::vector<Rift>& rifts,
                                  SurfaceGraph::Vertex camera_vertex, const RiftWeights& weights);

}  // namespace thalweg::surface
