#pragma once

#include <vector>

#include "common/surface_graph/surface_graph.h"
#include "common/surface_graph/view.h"

namespace thalweg::surface {

/// The surface graph of a single view.
struct ViewGraph {
  SurfaceGraph graph;
  std::vector<SurfaceGraph::Vertex> vertex_of_pixel;  ///< kNone where the pixel is not valid.
};

/// A vertex for each valid pixel, at c pi(r, c); an edge between pixels that are neighbors in a row or a
/// column and both valid. Linear in pixels.
///
/// The thesis's text says D[r +- 1, c +- 1], which might mean the diagonal neighbors, but "a vertex typically
/// has four neighbors" and twice as many edges as vertices (Table 5.1) leave only these.
ViewGraph GraphOf(const View& view);

/// Calls visit(pixel a, pixel b) for each pair of neighbors in a row or a column of the image.
template <class Visit>
void ForEachPixelPair(const View& view, Visit&& visit) {
  for (int v = 0; v < view.height_px(); ++v) {
    for (int u = 0; u < view.width_px(); ++u) {
      const std::size_t pixel = view.PixelAt(u, v);
      if (u > 0) visit(pixel - 1, pixel);
      if (v > 0) visit(view.PixelAt(u, v - 1), pixel);
    }
  }
}

}  // namespace thalweg::surface
