#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/surface_graph/path_search.h"

namespace thalweg::surface {

/// One panel of the comparison in Fig. 5.7 of the source thesis: a method on a grid with four neighbors.
struct GridSearch {
  std::string method;
  bool obstacle = false;
  int side = 0;                       ///< The grid has side * side places, 1 m apart.
  std::vector<bool> is_free;          ///< By place, row by row.
  std::vector<std::size_t> place_of;  ///< By vertex of the graph.
  SurfaceGraph::Vertex start = 0, goal = 0;
  FoundPath found;
};

/// Dijkstra, best-first and A* with the Manhattan estimate, Eq. (5.18), on an empty grid of 41 x 41 and on
/// one with a concave obstacle between start and goal, open toward the start. The thesis prints no sizes.
std::vector<GridSearch> SearchGrids();

/// A line of a table for people.
std::string ToText(const GridSearch& search);

/// One panel for each: what was looked at, the earlier the darker, and the path. 8 bit, blue, green, red.
cv::Mat Draw(const std::vector<GridSearch>& searches);

}  // namespace thalweg::surface
