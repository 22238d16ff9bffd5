#include "services/surface/evaluation/exploration.h"

#include <fmt/format.h>

#include <cmath>
#include <unordered_set>
#include <utility>

#include "common/base/check.h"
#include "common/base/require.h"

namespace thalweg::surface {
namespace {

constexpr double kCube = 0.05;  // [m]

std::size_t CubesOf(const Surface& surface) {
  std::unordered_set<std::uint64_t> cubes;
  for (SurfaceGraph::Vertex vertex = 0; vertex < surface.vertex_count(); ++vertex) {
    std::uint64_t key = 0;  // 21 bits for each axis: 100 km
    for (const float coordinate : surface.graph().Position(vertex)) {
      const auto index = static_cast<std::int64_t>(std::floor(coordinate / kCube));
      key = (key << 21U) | (static_cast<std::uint64_t>(index) & 0x1FFFFFU);
    }
    cubes.insert(key);
  }
  return cubes.size();
}

}  // namespace

void CheckOptions(const ExplorationOptions& options) {
  CheckOptions(options.surface);
  Require(options.moves >= 0 && options.moves <= 1000, "moves", options.moves, "0 to 1000");
  Require(options.views_per_move >= 1 && options.views_per_move <= 1000, "views_per_move",
          options.views_per_move, "1 to 1000");
}

SurfaceRow Measure(const std::string& name, const Surface& surface, const Move& move) {
  SurfaceRow row{.name = name,
                 .views = surface.views().size(),
                 .points = surface.raw_point_count(),
                 .vertices = surface.vertex_count(),
                 .edges = surface.edge_count(),
                 .area = surface.Area(),
                 .cubes = CubesOf(surface),
                 .rifts = move.rifts.size(),
                 .reachable_rifts = move.ranked.size()};
  for (const Rift& rift : move.rifts) row.rift_edges += rift.edges.size();
  return row;
}

std::vector<SearchRow> CompareSearches(const Surface& surface, const Move& move) {
  std::vector<SearchRow> rows;
  if (move.ranked.empty()) return rows;
  const SurfaceGraph::Vertex goal = move.rifts[move.ranked.front().rift].vertex;
  for (const auto& [name, method] :
       {std::pair("Dijkstra", SearchMethod::kDijkstra), std::pair("best first", SearchMethod::kBestFirst),
        std::pair("A*", SearchMethod::kAStar)}) {
    const FoundPath path = FindPath(surface.graph(), surface.CameraVertex(), goal, method);
    rows.push_back({name, path.length, path.looked_at.size()});
  }
  return rows;
}

std::string_view ToText(ExplorationEnd end) {
  switch (end) {
    case ExplorationEnd::kAllMoves:
      return "all moves made";
    case ExplorationEnd::kNoRift:
      return "no rift left";
    case ExplorationEnd::kNoWay:
      return "no path to a rift";
    case ExplorationEnd::kNoNormal:
      return "dominant rift without a normal";
    case ExplorationEnd::kNowhere:
      return "no pose of the way possible";
  }
  THALWEG_CHECK(false);
}

Exploration Explore(View first, const Camera& camera, const ExplorationOptions& options,
                    const ExplorationListener& listener) {
  CheckOptions(options);
  Exploration made{.surface = Surface(options.surface)};
  std::size_t deleted = made.surface.Add(std::move(first)).deleted;
  while (true) {
    const Move move = made.surface.PlanMove();
    SurfaceRow row =
        Measure(made.moves == 0 ? "first view" : fmt::format("move {}", made.moves), made.surface, move);
    row.deleted_edges = std::exchange(deleted, 0);
    if (listener.measured) listener.measured(row, made.surface, move);
    if (made.moves == options.moves || move.poses.empty()) {
      if (made.moves < options.moves) {
        made.end = move.rifts.empty()    ? ExplorationEnd::kNoRift
                   : move.ranked.empty() ? ExplorationEnd::kNoWay
                                         : ExplorationEnd::kNoNormal;
      }
      return made;
    }
    ++made.moves;
    const std::size_t views_before = made.surface.views().size();
    const std::vector<CameraPose> poses = PosesToLookFrom(move.poses, options.views_per_move);
    for (int k = 1; k <= options.views_per_move; ++k) {
      const auto& [T_WC, above_W] = poses[static_cast<std::size_t>(k - 1)];
      Result<View> view = camera(T_WC, above_W);
      if (view) {
        deleted += made.surface.Add(*std::move(view)).deleted;
      } else if (listener.refused) {
        listener.refused(
            fmt::format("move {}, view {} of {}: {}", made.moves, k, options.views_per_move, view.error()));
      }
    }
    if (made.surface.views().size() == views_before) {
      made.end = ExplorationEnd::kNowhere;
      return made;
    }
  }
}

Surface AddEach(std::size_t count, const std::function<NamedView(std::size_t)>& load,
                const SurfaceOptions& options, const ExplorationListener& listener) {
  Surface surface(options);
  for (std::size_t k = 0; k < count; ++k) {
    NamedView next = load(k);
    if (!next.view.HasMeasurement()) {
      if (listener.refused) listener.refused(next.name + ": no pixel has a measurement");
      continue;
    }
    const std::size_t deleted = surface.Add(std::move(next.view)).deleted;
    const Move move = surface.PlanMove();
    SurfaceRow row = Measure(next.name, surface, move);
    row.deleted_edges = deleted;
    if (listener.measured) listener.measured(row, surface, move);
  }
  return surface;
}

std::string RowHeading() {
  return fmt::format("{:<26} {:>5} {:>10} {:>9} {:>9} {:>8} {:>9} {:>6} {:>11} {:>9} {:>7}\n", "", "views",
                     "raw points", "vertices", "edges", "surface", "5 cm", "rifts", "their edges",
                     "reachable", "deleted") +
         fmt::format("{:<26} {:>5} {:>10} {:>9} {:>9} {:>8} {:>9} {:>6} {:>11} {:>9} {:>7}\n", "", "", "", "",
                     "", "[m^2]", "cubes", "", "", "", "edges");
}

std::string RowLegend() {
  return R"(
  views: those from which it has looked; raw points: their valid pixels; vertices: after merging; surface: area
  5 cm cubes: those that contain a vertex; rifts, their edges: holes in the surface, edges longer than --rift-edge-m
  reachable: rifts to which a path over the surface leads; deleted edges: by this view or move, seen through
  below each row: paths from what the camera looks at to the dominant rift, by three searches
)";
}

std::string ToText(const SurfaceRow& row) {
  return fmt::format("{:<26} {:>5} {:>10} {:>9} {:>9} {:>8.2f} {:>9} {:>6} {:>11} {:>9} {:>7}\n", row.name,
                     row.views, row.points, row.vertices, row.edges, row.area, row.cubes, row.rifts,
                     row.rift_edges, row.reachable_rifts, row.deleted_edges);
}

std::string ToText(const SearchRow& row) {
  return fmt::format("  {:<10} {:8.3f} m, looked at {} vertices\n", row.method, row.length, row.looked_at);
}

nlohmann::ordered_json ToJson(const SurfaceRow& row) {
  return {{"name", row.name},
          {"views", row.views},
          {"raw_points", row.points},
          {"vertices", row.vertices},
          {"edges", row.edges},
          {"area_m2", row.area},
          {"cubes_5cm", row.cubes},
          {"rifts", row.rifts},
          {"rift_edges", row.rift_edges},
          {"reachable_rifts", row.reachable_rifts},
          {"deleted_edges", row.deleted_edges}};
}

nlohmann::ordered_json ToJson(const SearchRow& row) {
  return {{"method", row.method}, {"length_m", row.length}, {"looked_at", row.looked_at}};
}

}  // namespace thalweg::surface
