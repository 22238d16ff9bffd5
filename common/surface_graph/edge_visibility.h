#pragma once

#include <cstdlib>

#include "common/surface_graph/surface_graph.h"
#include "common/surface_graph/view.h"

namespace thalweg::surface {

struct EdgeVisibilityOptions {
  double share = 0.75;  ///< An edge is deleted if more than this share of its pixels is seen through.
  /// [m] How much nearer to the camera than the surface behind it a point of an edge must be. As printed this
  /// is 0; but then an edge between two pixels is seen through in its own image, by rounding.
  double margin = 0.01;
};

/// Calls visit(u, v) for each pixel of the straight line between two pixels, including both [Bresenham:
/// Algorithm for computer control of a digital plotter, IBM Systems Journal 4(1), 1965].
template <class Visit>
void ForEachPixelOfLine(int u, int v, int u_end, int v_end, Visit&& visit) {
  const int du = std::abs(u_end - u);
  const int dv = -std::abs(v_end - v);
  const int step_u = u < u_end ? 1 : -1;
  const int step_v = v < v_end ? 1 : -1;
  int error = du + dv;
  for (;;) {
    visit(u, v);
    if (u == u_end && v == v_end) return;
    const int doubled = 2 * error;
    if (doubled >= dv) {
      error += dv;
      u += step_u;
    }
    if (doubled <= du) {
      error += du;
      v += step_v;
    }
  }
}

/// Whether a view shows that there is no surface along the straight line between two points (Section 5.7 of
/// the source thesis). The ends are projected into the image; along the Bresenham pixels between them, a
/// valid pixel passes where the line's point is nearer to the camera than what the pixel shows. True if more
/// than the share of all these pixels pass. False if an end lies outside the image or behind the camera.
/// @param a_C, b_C  [m] In the view's camera frame.
bool IsSeenThrough(const View& view, const Eigen::Vector3d& a_C, const Eigen::Vector3d& b_C,
                   const EdgeVisibilityOptions& options);

/// Deletes the edges that are seen through, among those from number `first` on with a weight of at least
/// `delta_m`. Returns how many.
///
/// Departure: the thesis does not say which edges are tested. Only those of rifts are, since shorter ones
/// compare a surface with itself, and of two views of one noisy surface either is nearer half the time.
std::size_t DeleteEdgesSeenThrough(const View& view, double delta_m, SurfaceGraph::Edge first,
                                   const EdgeVisibilityOptions& options, SurfaceGraph& graph);

}  // namespace thalweg::surface
