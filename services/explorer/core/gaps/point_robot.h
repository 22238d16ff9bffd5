#pragma once

#include <optional>
#include <vector>

#include "services/explorer/core/gaps/critical_rays.h"
#include "services/explorer/core/gaps/gap_tree.h"

namespace thalweg::explorer {

/// A simulated point robot with an ideal gap sensor. It can do one thing, chase a gap, and reports one
/// critical event at a time [Tovar, Murrieta-Cid, LaValle 2007].
///
/// The chase: straight to the gap's vertex, up to a small distance, and then around the vertex at that
/// distance, toward the side that it hides. So the line of sight past the vertex sweeps what is hidden until
/// something comes into sight, or until the next wall does. If that wall ends in another reflex vertex, the
/// gap is there now, and the chase goes on to it.
///
/// Events come from crossings of the path and the polygon's critical rays, a closed form, not from small
/// steps. Departures from the paper, whose robot touches the vertices and stops where the event is: this one
/// rounds a vertex at `clearance`, on chords of 10 degrees, and stops a little after an event, at most
/// halfway to the next one, so that every position is in general position and has a definite set of gaps.
class PointRobot {
 public:
  struct Options {
    /// [m] At which vertices are rounded; a quarter of the room around the vertex where that is less.
    double clearance = 0.02;
  };

  /// The polygon must outlive the robot. Throws std::invalid_argument where the polygon is not in general
  /// position, or the start not inside it.
  PointRobot(const Polygon& polygon, const Eigen::Vector2d& start, const Options& options);

  const Eigen::Vector2d& position() const { return path_.back(); }
  const std::vector<Eigen::Vector2d>& path() const { return path_; }
  double length() const { return length_; }  ///< [m] The path's.

  /// The vertices of the gaps in sight, by slot. For the simulation and its tests: the tree never sees them.
  const std::vector<std::size_t>& gaps() const { return gaps_; }
  double smallest_step() const { return smallest_step_; }  ///< [m] The least from an event to its stop.

  /// Moves until the first critical event. Throws std::runtime_error where rounding hides what comes first,
  /// which takes a polygon or path that is not in general position.
  GapEvent Chase(std::size_t slot);

  /// Moves straight ahead until the first critical event or to the goal, which has to be in sight and to have
  /// half the clearance of free space behind it.
  std::optional<GapEvent> MoveTowards(const Eigen::Vector2d& goal);

 private:
  double ClearanceAt(std::size_t vertex) const;
  /// Moves straight to the goal, or to just after the first ray in between, at most `beyond` after it.
  const CriticalRay* Move(const Eigen::Vector2d& goal, double beyond);
  std::optional<GapEvent> Update(const CriticalRay& ray);  ///< The gaps; no event where one slides.
  std::size_t SlotOf(std::size_t vertex) const;
  std::size_t SlotFor(std::size_t vertex) const;  ///< Where a new gap at the vertex belongs.

  const Polygon& polygon_;
  Options options_;
  std::vector<CriticalRay> rays_;
  std::vector<std::size_t> gaps_;
  std::vector<Eigen::Vector2d> path_;
  double length_ = 0.0;
  double smallest_step_;
};

}  // namespace thalweg::explorer
