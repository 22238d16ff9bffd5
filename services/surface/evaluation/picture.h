#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "common/surface_graph/surface.h"
#include "services/surface/evaluation/framed_picture.h"

namespace thalweg::surface {

/// What a picture of a surface is drawn for.
struct Viewpoint {
  PinholeCamera camera;
  RigidTransform T_WC;
};

/// From behind the first camera, higher and to the side, far enough to have all vertices in the picture.
Viewpoint BesideFirstCamera(const Surface& surface);

/// The color of each vertex: of the first pixel that showed it, or gray where views have no colors. Rift
/// vertices, which come last, are gray.
std::vector<Rgb> VertexColors(const Surface& surface);

/// Green for no weight, over yellow, to red for a weight of delta_m and more.
Rgb WeightColor(double weight, double delta_m);

// Pictures in the manner of the thesis's figures 5.2, 5.3, 5.8 and 5.12: 8 bit, blue, green, red. What is
// behind something nearer is hidden; walls that are seen from behind are left out.

/// The edges, from green to red by weight.
cv::Mat DrawEdges(const Surface& surface, const Viewpoint& from);
std::vector<Meaning> LegendOfEdges(double delta_m);
/// The surface in gray with each rift in a color of its own, the dominant one red and thick, and the rift
/// vertices of those with at least 1 % of its edges as discs.
cv::Mat DrawRifts(const Surface& surface, const Move& move, const Viewpoint& from);
std::vector<Meaning> LegendOfRifts();
/// The surface in its colors, the path over it (yellow) to the dominant rift (red), the camera's trajectory
/// (blue), and the poses at which it looks.
/// @param views  How many of these there are.
cv::Mat DrawTrajectory(const Surface& surface, const Move& move, int views, const Viewpoint& from);
std::vector<Meaning> LegendOfTrajectory();

}  // namespace thalweg::surface
