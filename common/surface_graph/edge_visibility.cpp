#include "common/surface_graph/edge_visibility.h"

#include <algorithm>

namespace thalweg::surface {

bool IsSeenThrough(const View& view, const Eigen::Vector3d& a_C, const Eigen::Vector3d& b_C,
                   const EdgeVisibilityOptions& options) {
  const std::optional<std::size_t> pixel_a = view.PixelOf(a_C);
  const std::optional<std::size_t> pixel_b = view.PixelOf(b_C);
  if (!pixel_a || !pixel_b) return false;
  const auto width = static_cast<std::size_t>(view.width_px());
  const auto u_a = static_cast<int>(*pixel_a % width);
  const auto v_a = static_cast<int>(*pixel_a / width);
  const auto u_b = static_cast<int>(*pixel_b % width);
  const auto v_b = static_cast<int>(*pixel_b / width);
  const int steps = std::max(std::abs(u_b - u_a), std::abs(v_b - v_a));
  int pixels = 0;
  int passed = 0;
  ForEachPixelOfLine(u_a, v_a, u_b, v_b, [&](int u, int v) {
    // Along a straight line in the image the inverse depth of a straight line in space is linear.
    const double along = steps > 0 ? static_cast<double>(pixels) / steps : 0.0;
    const double depth = 1.0 / ((1.0 - along) / a_C.z() + along / b_C.z());
    const std::size_t pixel = view.PixelAt(u, v);
    ++pixels;
    if (view.IsValid(pixel) && depth + options.margin < view.DepthAt(pixel)) ++passed;
  });
  return passed > options.share * pixels;
}

std::size_t DeleteEdgesSeenThrough(const View& view, double delta_m, SurfaceGraph::Edge first,
                                   const EdgeVisibilityOptions& options, SurfaceGraph& graph) {
  const RigidTransform T_CW = view.T_WC.inverse();
  std::size_t deleted = 0;
  for (SurfaceGraph::Edge edge = first; edge < graph.edge_numbers(); ++edge) {
    if (!graph.Exists(edge) || graph.Weight(edge) < delta_m) continue;
    const Eigen::Vector3d a_C = T_CW * graph.Position(graph.End(edge, 0)).cast<double>();
    const Eigen::Vector3d b_C = T_CW * graph.Position(graph.End(edge, 1)).cast<double>();
    if (!IsSeenThrough(view, a_C, b_C, options)) continue;
    graph.RemoveEdge(edge);
    ++deleted;
  }
  return deleted;
}

}  // namespace thalweg::surface
