#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/surface_graph/surface.h"

namespace thalweg::surface {

/// A row of Table 5.1 of the source thesis, and more.
struct SurfaceRow {
  std::string name;
  std::size_t views = 0;
  std::size_t points = 0;  ///< Raw: valid pixels of all views.
  std::size_t vertices = 0;
  std::size_t edges = 0;
  double area = 0.0;  ///< [m^2] See Surface::Area: what was not merged counts twice.
  /// Cubes of 5 cm that contain a vertex: a measure of the surface in which nothing counts twice.
  std::size_t cubes = 0;
  std::size_t rifts = 0;
  std::size_t rift_edges = 0;
  std::size_t reachable_rifts = 0;  ///< Those that a path leads to.
  std::size_t deleted_edges = 0;    ///< Seen through, since the row before.
};

/// How one of the methods found the way to the dominant rift.
struct SearchRow {
  std::string method;
  double length = 0.0;  ///< [m]
  std::size_t looked_at = 0;
};

/// A camera that can be sent somewhere.
/// @param T_WC   Where it looks from.
/// @param above  [m] The point of the surface that this is above, in W.
/// @return       Nothing if it cannot go there, with the reason.
using Camera = std::function<Result<View>(const RigidTransform& T_WC, const Eigen::Vector3d& above_W)>;

struct ExplorationOptions {
  SurfaceOptions surface;
  int moves = 1;
  /// The thesis's experiments have four intermediate poses a move; the last one above the rift is taken to be
  /// the fourth.
  int views_per_move = 4;
};

/// Throws std::invalid_argument naming the bad option.
void CheckOptions(const ExplorationOptions& options);

/// Measures a surface and its rifts.
/// @param move  As planned on it.
SurfaceRow Measure(const std::string& name, const Surface& surface, const Move& move);

/// The three methods on the way from the camera's vertex to the dominant rift. Empty if there is no such way.
/// @param move  Planned on this surface, so that its rift vertices are in the graph.
std::vector<SearchRow> CompareSearches(const Surface& surface, const Move& move);

/// What an exploration reports, as it goes on.
struct ExplorationListener {
  /// After the first view, and after each move.
  std::function<void(const SurfaceRow&, const Surface&, const Move&)> measured;
  /// A pose of the camera's way that it could not take, or a view that was left out, and why.
  std::function<void(const std::string&)> refused;
};

/// Why an exploration ended.
enum class ExplorationEnd : std::uint8_t {
  kAllMoves,  ///< It has made as many moves as the options allow.
  kNoRift,    ///< None is left.
  kNoWay,     ///< No path over the surface leads from what the camera looks at to a rift that is left.
  kNoNormal,  ///< The dominant rift has no normal, along which to look.
  kNowhere,   ///< The camera could take no pose of its way, so that the next move would be the same.
};
std::string_view ToText(ExplorationEnd end);

struct Exploration {
  Surface surface;
  ExplorationEnd end = ExplorationEnd::kAllMoves;
  int moves = 0;  ///< Made, the last perhaps in vain.
};

/// The experiment of Table 5.1: looks once, then goes to the dominant rift and looks on the way, as often as
/// the options say, or until it can go on no longer.
/// @param first  View from where it starts.
Exploration Explore(View first, const Camera& camera, const ExplorationOptions& options,
                    const ExplorationListener& listener);

/// A view and what it is called.
struct NamedView {
  std::string name;
  View view;
};

/// The experiment on views that were taken before: adds one after the other, each a row of its own.
/// A view without any measurement is left out, and the listener is given its name.
/// @param load  View number 0 to `count` - 1; asked in this order, each once. What it throws is passed on.
Surface AddEach(std::size_t count, const std::function<NamedView(std::size_t)>& load,
                const SurfaceOptions& options, const ExplorationListener& listener);

/// Lines of a table for people.
std::string RowHeading();
std::string RowLegend();
std::string ToText(const SurfaceRow& row);
std::string ToText(const SearchRow& row);
nlohmann::ordered_json ToJson(const SurfaceRow& row);
nlohmann::ordered_json ToJson(const SearchRow& row);

}  // namespace thalweg::surface
