#pragma once

#include <optional>
#include <vector>

#include "common/surface_graph/camera_trajectory.h"
#include "common/surface_graph/edge_visibility.h"
#include "common/surface_graph/merge.h"
#include "common/surface_graph/path_search.h"
#include "common/surface_graph/rift_choice.h"

namespace thalweg::surface {

/// The thesis prints values for all but the height.
struct SurfaceOptions {
  double rift_edge = 0.1;        ///< [m] delta_m: longer edges are rifts.
  double merge_distance = 0.01;  ///< [m] gamma: nearer points are one, and margin of visibility.
  double seen_through = 0.75;    ///< Share of an edge's pixels that must be seen through to delete it.
  RiftWeights weights;
  double height = 1.0;  ///< [m] delta_h: of the camera above the surface.
};

/// Throws std::invalid_argument naming the bad option.
void CheckOptions(const SurfaceOptions& options);

/// What a view did to the surface.
struct Addition {
  std::size_t points = 0;   ///< Valid pixels of the view.
  std::size_t dropped = 0;  ///< Those that the graph had already.
  std::size_t deleted = 0;  ///< Edges that were seen through.
};

/// Where to look next.
struct Move {
  std::vector<Rift> rifts;         ///< With their vertices in the graph.
  std::vector<RankedRift> ranked;  ///< The dominant rift first; empty if the camera can reach none.
  FoundPath path;                  ///< To the dominant rift.
  std::vector<CameraPose> poses;   ///< Along the path.
  std::optional<Eigen::Vector3d> rift_normal;  ///< The dominant rift's; without one there are no poses.
};

/// Exploration by rifts, as Chapter 5 of the source thesis prints it: the graph of all views, each merged
/// with the one before it, and each edge tested against every view.
///
/// All images are kept and memory grows with the number of views, two of the faults that the thesis itself
/// names. Departure: rift vertices are in the graph only from PlanMove until the next view.
/// Threading: one thread owns a surface.
class Surface {
 public:
  explicit Surface(const SurfaceOptions& options);

  /// @param view  Without mistakes, see MistakeIn.
  Addition Add(View view);
  /// Finds the rifts, chooses one and plans the camera's path there.
  Move PlanMove();

  const SurfaceGraph& graph() const { return graph_; }
  const std::vector<MergedView>& views() const { return views_; }
  const SurfaceOptions& options() const { return options_; }
  std::size_t raw_point_count() const { return raw_points_; }
  std::size_t vertex_count() const;  ///< Without rift vertices, which come last.
  std::size_t edge_count() const;    ///< Without theirs.

  /// What the last view's camera looks at: the vertex of the valid pixel that is nearest to the principal
  /// point; kNone if no pixel is valid. The thesis does not define it.
  SurfaceGraph::Vertex CameraVertex() const;
  /// [m] Position of the camera that saw a vertex first; for a rift vertex, of the last camera.
  Eigen::Vector3d CameraOf(SurfaceGraph::Vertex vertex) const;

  /// Calls visit(corners) for each cell of the surface: four vertices, in order around it, that are neighbors
  /// in an image, at least one of which no earlier view has, with no side of delta_m or more. Corners that
  /// were merged may be the same vertex.
  template <class Visit>
  void ForEachCell(Visit&& visit) const;
  /// [m^2] Sum of the cells, as two triangles each. The thesis does not define it. Where two views of one
  /// surface were not merged, since they differ by gamma or more, it counts twice.
  double Area() const;

 private:
  void RemoveRiftVertices();

  SurfaceOptions options_;
  SurfaceGraph graph_;
  std::vector<MergedView> views_;
  std::vector<SurfaceGraph::Vertex> first_vertex_;  ///< For each view, the first that it added.
  std::size_t raw_points_ = 0;
  /// Sizes of the graph without the rift vertices that it contains at present.
  struct Size {
    std::size_t vertices = 0;
    std::size_t edge_numbers = 0;
    std::size_t edges = 0;
  };
  std::optional<Size> without_rifts_;
};

template <class Visit>
void Surface::ForEachCell(Visit&& visit) const {
  const auto is_short = [&](SurfaceGraph::Vertex a, SurfaceGraph::Vertex b) {
    return (graph_.Position(a) - graph_.Position(b)).norm() < options_.rift_edge;
  };
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const auto& [view, vertex_of_pixel] = views_[i];
    for (int v = 1; v < view.height_px(); ++v) {
      for (int u = 1; u < view.width_px(); ++u) {
        const SurfaceGraph::Vertex corners[4] = {
            vertex_of_pixel[view.PixelAt(u - 1, v - 1)], vertex_of_pixel[view.PixelAt(u - 1, v)],
            vertex_of_pixel[view.PixelAt(u, v)], vertex_of_pixel[view.PixelAt(u, v - 1)]};
        bool is_cell = true;
        bool is_new = false;
        for (const SurfaceGraph::Vertex corner : corners) {
          is_cell = is_cell && corner != SurfaceGraph::kNone;
          is_new = is_new || corner >= first_vertex_[i];
        }
        if (!is_cell || !is_new) continue;
        for (int k = 0; k < 4; ++k) is_cell = is_cell && is_short(corners[k], corners[(k + 1) % 4]);
        if (is_cell) visit(corners);
      }
    }
  }
}

}  // namespace thalweg::surface
