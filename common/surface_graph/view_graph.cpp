#include "common/surface_graph/view_graph.h"

namespace thalweg::surface {

ViewGraph GraphOf(const View& view) {
  ViewGraph result;
  const std::size_t pixels = view.disparities.size();
  result.graph.Reserve(pixels, 2 * pixels);
  result.vertex_of_pixel.assign(pixels, SurfaceGraph::kNone);
  const auto vertex_at = [&](std::size_t pixel) { return result.vertex_of_pixel[pixel]; };
  for (int v = 0; v < view.height_px(); ++v) {
    for (int u = 0; u < view.width_px(); ++u) {
      const std::size_t pixel = view.PixelAt(u, v);
      if (!view.IsValid(pixel)) continue;
      const auto vertex = result.graph.AddVertex((view.T_WC * view.PointAt(pixel)).cast<float>());
      result.vertex_of_pixel[pixel] = vertex;
      if (u > 0 && vertex_at(pixel - 1) != SurfaceGraph::kNone) {
        result.graph.AddEdge(vertex_at(pixel - 1), vertex);
      }
      const std::size_t above = v > 0 ? view.PixelAt(u, v - 1) : pixel;
      if (v > 0 && vertex_at(above) != SurfaceGraph::kNone) result.graph.AddEdge(vertex_at(above), vertex);
    }
  }
  return result;
}

}  // namespace thalweg::surface
