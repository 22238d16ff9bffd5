#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/explorer/core/gaps/polygon.h"

namespace thalweg::explorer {

/// A side of a line of sight.
enum class GapSide : std::uint8_t { kLeft, kRight };

/// A discontinuity of the distance to the walls, as a function of the direction of view. The wall's vertex
/// that causes it hides a connected region, a pocket, on one side of the line of sight.
struct Gap {
  double direction = 0.0;  ///< [rad] Counterclockwise from x, in (-pi, pi].
  std::size_t vertex = 0;  ///< Its near end: a reflex vertex.
  GapSide hidden = GapSide::kLeft;
};

/// Which side a reflex vertex hides from a viewpoint that sees it; none where it sees both of its walls.
std::optional<GapSide> HiddenSide(const Polygon& polygon, const Eigen::Vector2d& viewpoint,
                                  std::size_t vertex);

/// The neighbor of a vertex at the end of the wall that a gap there hides.
std::size_t HiddenNeighbor(const Polygon& polygon, std::size_t vertex, GapSide hidden);

/// The gaps that an ideal sensor detects, counterclockwise from direction -pi [Tovar, Murrieta-Cid, LaValle:
/// Distance-optimal navigation in an unknown environment without sensing distances, T-RO 23(3), 2007]
/// @param viewpoint  Inside the polygon, on no line through two of its vertices that see each other.
std::vector<Gap> SenseGaps(const Polygon& polygon, const Eigen::Vector2d& viewpoint);

/// All that is in sight, a polygon that is star-shaped around the viewpoint, counterclockwise. O(n^2).
/// Every vertex in sight is a vertex of it; a vertex that causes a gap comes with the place where the line of
/// sight past it meets a wall.
/// @param viewpoint  As in SenseGaps.
std::vector<Eigen::Vector2d> VisibilityPolygon(const Polygon& polygon, const Eigen::Vector2d& viewpoint);

/// The region that a gap hides: its vertices, counterclockwise, the gap's vertex included. O(n).
std::vector<Eigen::Vector2d> PocketOf(const Polygon& polygon, const Eigen::Vector2d& viewpoint,
                                      const Gap& gap);

/// Whether a point is in sight from some place of a straight piece of a path. Exact but for rounding: it
/// comes into sight only where the line of sight passes a vertex; between two such places one test is enough.
bool IsSeenFromSegment(const Polygon& polygon, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                       const Eigen::Vector2d& point);

}  // namespace thalweg::explorer
