#include "common/surface_graph/rift_choice.h"

#include <algorithm>
#include <cmath>

#include "common/surface_graph/path_search.h"

namespace thalweg::surface {

std::vector<RankedRift> RankRifts(const SurfaceGraph& graph, const std::vector<Rift>& rifts,
                                  SurfaceGraph::Vertex camera_vertex, const RiftWeights& weights) {
  const std::vector<double> lengths = LengthsFrom(graph, camera_vertex);
  std::vector<RankedRift> ranked;
  for (std::size_t i = 0; i < rifts.size(); ++i) {
    const double distance = lengths[rifts[i].vertex];
    if (!std::isfinite(distance)) continue;
    const double weight =
        weights.distance * distance + weights.edges * static_cast<double>(rifts[i].edges.size());
    ranked.push_back({i, distance, weight});  // Eq. (5.11)
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const RankedRift& a, const RankedRift& b) { return a.weight > b.weight; });
  return ranked;
}

}  // namespace thalweg::surface
