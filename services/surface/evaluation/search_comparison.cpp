#include "services/surface/evaluation/search_comparison.h"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>

namespace thalweg::surface {
namespace {

constexpr int kSide = 41;
constexpr int kPixel = 10;  // of a place in the picture
constexpr int kMargin = 20;

std::size_t PlaceAt(int x, int y) {
  return static_cast<std::size_t>(y * kSide + x);
}

/// A U on its side: its bottom at x = 28, its arms reaching back to x = 14, the lower one nearer.
bool IsObstacle(int x, int y) {
  const bool bottom = x == 28 && y >= 8 && y <= 34;
  const bool arm = (y == 8 || y == 34) && x >= 14 && x <= 28;
  return bottom || arm;
}

GridSearch SearchGrid(const std::string& name, SearchMethod method, bool obstacle) {
  GridSearch search;
  search.method = name;
  search.obstacle = obstacle;
  search.side = kSide;
  SurfaceGraph graph;
  std::vector<SurfaceGraph::Vertex> vertex_at(kSide * kSide, SurfaceGraph::kNone);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const bool is_free = !obstacle || !IsObstacle(x, y);
      search.is_free.push_back(is_free);
      if (!is_free) continue;
      const auto vertex = graph.AddVertex({static_cast<float>(x), static_cast<float>(y), 0.0F});
      vertex_at[PlaceAt(x, y)] = vertex;
      search.place_of.push_back(PlaceAt(x, y));
      if (x > 0 && vertex_at[PlaceAt(x - 1, y)] != SurfaceGraph::kNone) {
        graph.AddEdge(vertex_at[PlaceAt(x - 1, y)], vertex);
      }
      if (y > 0 && vertex_at[PlaceAt(x, y - 1)] != SurfaceGraph::kNone) {
        graph.AddEdge(vertex_at[PlaceAt(x, y - 1)], vertex);
      }
    }
  }
  search.start = vertex_at[PlaceAt(6, 20)];
  search.goal = vertex_at[PlaceAt(36, 26)];
  search.found = FindPath(graph, search.start, search.goal, method, Heuristic::kManhattan);
  return search;
}

cv::Mat Panel(const GridSearch& search) {
  cv::Mat_<cv::Vec3b> panel(kSide * kPixel, kSide * kPixel, cv::Vec3b(255, 255, 255));
  const auto fill = [&](std::size_t place, const cv::Scalar& color, int inset) {
    const auto x = static_cast<int>(place % kSide);
    const auto y = static_cast<int>(place / kSide);
    const cv::Rect area(x * kPixel + inset, y * kPixel + inset, kPixel - 2 * inset, kPixel - 2 * inset);
    cv::rectangle(panel, area, color, cv::FILLED);
  };
  const std::size_t looked_at = search.found.looked_at.size();
  for (std::size_t i = 0; i < looked_at; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(looked_at);
    fill(search.place_of[search.found.looked_at[i]],
         cv::Scalar(215 - 15 * (1 - share), 150 + 75 * share, 60 + 140 * share), 0);
  }
  for (std::size_t place = 0; place < search.is_free.size(); ++place) {
    if (!search.is_free[place]) fill(place, cv::Scalar(60, 60, 60), 0);
  }
  for (const SurfaceGraph::Vertex vertex : search.found.vertices) {
    fill(search.place_of[vertex], cv::Scalar(38, 30, 214), 3);
  }
  fill(search.place_of[search.start], cv::Scalar(60, 150, 20), 0);
  fill(search.place_of[search.goal], cv::Scalar(38, 30, 214), 0);
  cv::rectangle(panel, cv::Rect(0, 0, panel.cols, panel.rows), cv::Scalar(120, 120, 120), 1);
  return panel;
}

}  // namespace

std::vector<GridSearch> SearchGrids() {
  std::vector<GridSearch> searches;
  for (const bool obstacle : {false, true}) {
    searches.push_back(SearchGrid("Dijkstra", SearchMethod::kDijkstra, obstacle));
    searches.push_back(SearchGrid("best first", SearchMethod::kBestFirst, obstacle));
    searches.push_back(SearchGrid("A*", SearchMethod::kAStar, obstacle));
  }
  return searches;
}

std::string ToText(const GridSearch& search) {
  return fmt::format("{:<10} {:<17} path {:4.0f}, looked at {:>4} of {} vertices\n", search.method,
                     search.obstacle ? "concave obstacle" : "no obstacle", search.found.length,
                     search.found.looked_at.size(), search.place_of.size());
}

cv::Mat Draw(const std::vector<GridSearch>& searches) {
  constexpr int kColumns = 3;
  constexpr int kStep = kSide * kPixel + kMargin;
  const int rows = static_cast<int>(searches.size() + kColumns - 1) / kColumns;
  cv::Mat_<cv::Vec3b> picture(rows * kStep + kMargin, kColumns * kStep + kMargin, cv::Vec3b(255, 255, 255));
  for (int i = 0; i < static_cast<int>(searches.size()); ++i) {
    const cv::Rect place(kMargin + (i % kColumns) * kStep, kMargin + (i / kColumns) * kStep, kSide * kPixel,
                         kSide * kPixel);
    Panel(searches[static_cast<std::size_t>(i)]).copyTo(picture(place));
  }
  return picture;
}

}  // namespace thalweg::surface
