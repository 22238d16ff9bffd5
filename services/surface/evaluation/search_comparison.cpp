#include "services/surface/evaluation/search_comparison.h"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>

#include "common/drawing/canvas.h"

namespace thalweg::surface {
namespace {

constexpr int kSide = 41;
constexpr int kPixel = 10;  // of a place in the picture
constexpr int kMargin = 20;
constexpr int kHeadline = 24;   // [px] above a panel
constexpr int kLegend = 30;  // [px] below all
const cv::Scalar kObstacle(60, 60, 60);
const cv::Scalar kPath(38, 30, 214);
const cv::Scalar kStart(60, 150, 20);

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

/// @param share  0 for the first that was looked at, 1 for the last.
cv::Scalar LookedAtColor(double share) {
  return {215 - 15 * (1 - share), 150 + 75 * share, 60 + 140 * share};
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
    fill(search.place_of[search.found.looked_at[i]], LookedAtColor(share), 0);
  }
  for (std::size_t place = 0; place < search.is_free.size(); ++place) {
    if (!search.is_free[place]) fill(place, kObstacle, 0);
  }
  for (const SurfaceGraph::Vertex vertex : search.found.vertices) {
    fill(search.place_of[vertex], kPath, 3);
  }
  fill(search.place_of[search.start], kStart, 0);
  fill(search.place_of[search.goal], kPath, 0);
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
  constexpr int kSize = kSide * kPixel;
  constexpr int kAcross = kSize + kMargin;
  constexpr int kDown = kHeadline + kSize + kMargin;
  constexpr double kLetters = 10.0;  // [px] Height of a capital letter.
  const int rows = static_cast<int>(searches.size() + kColumns - 1) / kColumns;
  Canvas canvas(kColumns * kAcross + kMargin, rows * kDown + kMargin + kLegend);
  for (int i = 0; i < static_cast<int>(searches.size()); ++i) {
    const GridSearch& search = searches[static_cast<std::size_t>(i)];
    const double x = kMargin + (i % kColumns) * kAcross;
    const double y = kMargin + (i / kColumns) * kDown;
    canvas.Text(fmt::format("{}: path {:.0f} m, looked at {} of {}", search.method, search.found.length,
                            search.found.looked_at.size(), search.place_of.size()),
                {x, y + kLetters}, kLetters, colors::kInk);
    canvas.Image({x, y + kHeadline, kSize, kSize}, Panel(search));
  }
  const double legend = rows * kDown + kMargin + 0.5 * kLegend - 0.5 * kMargin;
  double left = canvas.Swatch({kMargin, legend}, kStart, "start");
  left = canvas.Swatch({left, legend}, kPath, "path to the goal");
  left = canvas.Swatch({left, legend}, LookedAtColor(0.0), "looked at first");
  left = canvas.Swatch({left, legend}, LookedAtColor(1.0), "looked at last");
  canvas.Swatch({left, legend}, kObstacle, "obstacle");
  return canvas.Picture();
}

}  // namespace thalweg::surface
