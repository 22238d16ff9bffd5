#pragma once

#include <vector>

#include "common/surface_graph/view_graph.h"

namespace thalweg::surface {

/// A view and where its pixels are in the graph that it is merged into.
struct MergedView {
  View view;
  std::vector<SurfaceGraph::Vertex> vertex_of_pixel;  ///< kNone where the pixel is not valid.
};

struct Merging {
  std::vector<SurfaceGraph::Vertex> vertex_of_pixel;  ///< Where the new view's pixels are in the graph.
  std::size_t dropped = 0;                            ///< Vertices that were found in the graph.
  std::size_t added = 0;                              ///< Vertices that were not.
};

/// Algorithm 3 of the source thesis. A vertex v of the new view's graph G_{i+1} is projected into the image
/// D_i before it, [f x / z, f y / z]. Where that pixel is valid and |v - pi_i(pixel)| < gamma, v is dropped
/// and its edges go to the pixel's vertex; else v is added with its edges. Linear in the new view's pixels,
/// whatever the size of the graph.
///
/// Departures: the printed index of pi, i + 1, is read as i. An edge whose ends become one vertex is left
/// out, and so is one that the graph has already; the weight of an edge that moved is the distance of its new
/// ends.
/// @param before  View i; nothing for the first one.
/// @param gamma   [m]
Merging Merge(const ViewGraph& part, const View& view, const MergedView* before, double gamma,
              SurfaceGraph& graph);

}  // namespace thalweg::surface
