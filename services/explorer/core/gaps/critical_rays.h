#pragma once

#include <cstdint>
#include <vector>

#include "services/explorer/core/gaps/visibility.h"

namespace thalweg::explorer {

/// A line across free space at which the gaps in sight change: the ray from a reflex vertex `near`, straight
/// away from another vertex `far`, to the next wall. Who looks from the ray sees `far` right behind `near`;
/// on one side of the ray, the hidden one, `near` is in the way of it, on the other it is not.
///
/// The critical events of [Tovar, Murrieta-Cid, LaValle 2007], who take the walls to be smooth:
/// - The wall from `near` to `far` is straight and `far` is convex. The two then stand for an inflection of
///   the wall, and the ray for its inflection ray. Entering the hidden side, the gap at `near` appears;
///   leaving it, the gap disappears.
/// - `near` and `far` are reflex, see each other, and their line touches the walls at both: a bitangent.
///   Entering the hidden side, the gap at `far` merges into the one at `near`; leaving it, that one splits.
/// Departure, since corners stand for curves: where the wall from `near` to `far` is straight and both are
/// reflex, a single gap moves on from one to the other (`kSlide`). That is no event, and the gap the same.
struct CriticalRay {
  enum class Kind : std::uint8_t { kInflection, kBitangent, kSlide };

  Kind kind = Kind::kInflection;
  std::size_t near = 0;
  std::size_t far = 0;
  GapSide hidden = GapSide::kLeft;  ///< As seen when looking from `near` to `far`.
  Eigen::Vector2d start;            ///< Where `near` is.
  Eigen::Vector2d end;              ///< On a wall.

  /// Positive where a point lies on the hidden side.
  double Depth(const Eigen::Vector2d& point) const {
    const double left = Cross(start - end, point - start);
    return hidden == GapSide::kLeft ? left : -left;
  }
};

/// All critical rays of a polygon. O(n^3) at worst.
/// Throws std::invalid_argument where the polygon is not in general position: where another vertex lies on a
/// ray, or between the ray's two vertices, so that several events would come as one.
std::vector<CriticalRay> CriticalRays(const Polygon& polygon);

}  // namespace thalweg::explorer
