#include "common/surface_graph/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/check.h"
#include "common/base/require.h"
#include "common/surface_graph/plane_normal.h"

namespace thalweg::surface {
namespace {

constexpr double kLongest = 1000.0;  // [m] that an option may be

}  // namespace

void CheckOptions(const SurfaceOptions& options) {
  const auto is_length = [](double value) { return value > 0.0 && value <= kLongest; };
  const char* const length = "above 0 and at most 1000";
  const auto not_negative = [](double value) { return std::isfinite(value) && value >= 0.0; };
  Require(is_length(options.rift_edge), "rift_edge", options.rift_edge, length);
  Require(is_length(options.merge_distance), "merge_distance", options.merge_distance, length);
  Require(options.seen_through >= 0.0 && options.seen_through < 1.0, "seen_through", options.seen_through,
          "at least 0 and below 1");
  Require(not_negative(options.weights.distance), "weights.distance", options.weights.distance,
          "a number >= 0");
  Require(not_negative(options.weights.edges), "weights.edges", options.weights.edges, "a number >= 0");
  Require(is_length(options.height), "height", options.height, length);
}

Surface::Surface(const SurfaceOptions& options) : options_(options) {
  CheckOptions(options);
}

Addition Surface::Add(View view) {
  THALWEG_CHECK(!MistakeIn(view));
  RemoveRiftVertices();
  const ViewGraph part = GraphOf(view);
  const auto first_edge = static_cast<SurfaceGraph::Edge>(graph_.edge_numbers());
  first_vertex_.push_back(static_cast<SurfaceGraph::Vertex>(graph_.vertex_count()));
  Merging merging =
      Merge(part, view, views_.empty() ? nullptr : &views_.back(), options_.merge_distance, graph_);
  Addition addition{.points = part.graph.vertex_count(), .dropped = merging.dropped, .deleted = 0};
  raw_points_ += addition.points;
  const EdgeVisibilityOptions visibility{.share = options_.seen_through, .margin = options_.merge_distance};
  for (const MergedView& earlier : views_) {
    addition.deleted +=
        DeleteEdgesSeenThrough(earlier.view, options_.rift_edge, first_edge, visibility, graph_);
  }
  addition.deleted += DeleteEdgesSeenThrough(view, options_.rift_edge, 0, visibility, graph_);
  views_.push_back({std::move(view), std::move(merging.vertex_of_pixel)});
  return addition;
}

Move Surface::PlanMove() {
  RemoveRiftVertices();
  Move move;
  move.rifts = FindRifts(graph_, options_.rift_edge);
  without_rifts_ = {graph_.vertex_count(), graph_.edge_numbers(), graph_.edge_count()};
  AddRiftVertices(move.rifts, graph_);
  const SurfaceGraph::Vertex camera = CameraVertex();
  if (camera == SurfaceGraph::kNone) return move;
  move.ranked = RankRifts(graph_, move.rifts, camera, options_.weights);
  if (move.ranked.empty()) return move;
  const Rift& dominant = move.rifts[move.ranked.front().rift];
  const RigidTransform& T_WC = views_.back().view.T_WC;
  move.path = FindPath(graph_, camera, dominant.vertex, SearchMethod::kAStar);
  move.rift_normal = RiftNormal(graph_, dominant, T_WC.translation());
  if (move.rift_normal) {
    move.poses = CameraTrajectory(
        graph_, move.path.vertices, [this](SurfaceGraph::Vertex vertex) { return CameraOf(vertex); },
        *move.rift_normal, options_.height, T_WC);
  }
  return move;
}

void Surface::RemoveRiftVertices() {
  if (!without_rifts_) return;
  graph_.TruncateTo(without_rifts_->vertices, without_rifts_->edge_numbers);
  without_rifts_.reset();
}

std::size_t Surface::vertex_count() const {
  return without_rifts_ ? without_rifts_->vertices : graph_.vertex_count();
}

std::size_t Surface::edge_count() const {
  return without_rifts_ ? without_rifts_->edges : graph_.edge_count();
}

SurfaceGraph::Vertex Surface::CameraVertex() const {
  SurfaceGraph::Vertex nearest = SurfaceGraph::kNone;
  if (views_.empty()) return nearest;
  const auto& [view, vertex_of_pixel] = views_.back();
  double least = std::numeric_limits<double>::infinity();
  for (int v = 0; v < view.height_px(); ++v) {
    for (int u = 0; u < view.width_px(); ++u) {
      const SurfaceGraph::Vertex vertex = vertex_of_pixel[view.PixelAt(u, v)];
      const double distance = std::hypot(u - view.rig.camera.cx, v - view.rig.camera.cy);
      if (vertex == SurfaceGraph::kNone || distance >= least) continue;
      least = distance;
      nearest = vertex;
    }
  }
  return nearest;
}

Eigen::Vector3d Surface::CameraOf(SurfaceGraph::Vertex vertex) const {
  THALWEG_CHECK(!views_.empty() && vertex < graph_.vertex_count());
  if (vertex >= vertex_count()) return views_.back().view.T_WC.translation();
  const auto after = std::upper_bound(first_vertex_.begin(), first_vertex_.end(), vertex);
  return views_[static_cast<std::size_t>(after - first_vertex_.begin() - 1)].view.T_WC.translation();
}

double Surface::Area() const {
  double area = 0.0;
  ForEachCell([&](const SurfaceGraph::Vertex(&corners)[4]) {
    const auto edge_to = [&](int k) -> Eigen::Vector3d {
      return (graph_.Position(corners[k]) - graph_.Position(corners[0])).cast<double>();
    };
    area += 0.5 * (edge_to(1).cross(edge_to(2)).norm() + edge_to(2).cross(edge_to(3)).norm());
  });
  return area;
}

}  // namespace thalweg::surface
