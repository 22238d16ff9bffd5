#include "common/surface_graph/merge.h"

namespace thalweg::surface {
namespace {

using Vertex = SurfaceGraph::Vertex;

/// The vertex that view i has within gamma of a point, or kNone.
Vertex VertexAt(const MergedView& before, const RigidTransform& T_CW, const Eigen::Vector3d& p_W,
                double gamma) {
  const Eigen::Vector3d p_C = T_CW * p_W;
  const std::optional<std::size_t> pixel = before.view.PixelOf(p_C);
  if (!pixel || !before.view.IsValid(*pixel)) return SurfaceGraph::kNone;
  const bool same = (p_C - before.view.PointAt(*pixel)).norm() < gamma;
  return same ? before.vertex_of_pixel[*pixel] : SurfaceGraph::kNone;
}

}  // namespace

Merging Merge(const ViewGraph& part, const View& view, const MergedView* before, double gamma,
              SurfaceGraph& graph) {
  Merging merging;
  const auto first_new = static_cast<Vertex>(graph.vertex_count());
  const RigidTransform T_CW = before ? before->view.T_WC.inverse() : RigidTransform::Identity();
  merging.vertex_of_pixel.assign(part.vertex_of_pixel.size(), SurfaceGraph::kNone);
  for (std::size_t pixel = 0; pixel < part.vertex_of_pixel.size(); ++pixel) {
    const Vertex vertex = part.vertex_of_pixel[pixel];
    if (vertex == SurfaceGraph::kNone) continue;
    const Eigen::Vector3f& p_W = part.graph.Position(vertex);
    const Vertex known = before ? VertexAt(*before, T_CW, p_W.cast<double>(), gamma) : SurfaceGraph::kNone;
    merging.vertex_of_pixel[pixel] = known == SurfaceGraph::kNone ? graph.AddVertex(p_W) : known;
    ++(known == SurfaceGraph::kNone ? merging.added : merging.dropped);
  }
  ForEachPixelPair(view, [&](std::size_t pixel_a, std::size_t pixel_b) {
    const Vertex a = merging.vertex_of_pixel[pixel_a];
    const Vertex b = merging.vertex_of_pixel[pixel_b];
    if (a == SurfaceGraph::kNone || b == SurfaceGraph::kNone || a == b) return;
    const bool both_new = a >= first_new && b >= first_new;
    if (both_new || !graph.AreNeighbors(a, b)) graph.AddEdge(a, b);
  });
  return merging;
}

}  // namespace thalweg::surface
