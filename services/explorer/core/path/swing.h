#pragma once

#include <optional>
#include <vector>

#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// How a robot goes over from one straight flight to another without standing in between.
///
/// From a velocity v to a velocity v' constant acceleration a is the quickest way, and takes
/// T = |v' - v| / a. It is an arc of a parabola, p(t) = p + v t + (v' - v) t^2 / (2 T), whose end lies
/// (v + v') T / 2 from its beginning. The speed on the way is least where the acceleration is across it, at
/// the tip, where a robot that turns back stands.
struct Swing {
  std::vector<Eigen::Vector3d> arc_W;   ///< [m] To where the straight flight begins; at least one point.
  std::vector<Eigen::Vector3d> rest_W;  ///< [m] From the straight flight's end to that of the path.
};

/// A robot in flight, and what it can.
struct Flight {
  Eigen::Vector3d p_W;            ///< [m]
  Eigen::Vector3d v_W;            ///< [m/s] Not 0.
  double max_speed = 0.0;         ///< [m/s]
  double max_acceleration = 0.0;  ///< [m/s^2]
};

/// A swing onto a path: to one of its next vertices, at one of several speeds, whichever takes the least time
/// if there are no more corners after that vertex. A tenth of the acceleration is spared, since a controller
/// follows polylines.
/// @param path_W     Two points or more.
/// @param clearance  [m] The body keeps this distance from all that is occupied or unknown.
/// @return           Empty when none that turns by less than 120 degrees is clear.
std::optional<Swing> SwingOnto(const PlanningMap& map, const Flight& flight,
                               const std::vector<Eigen::Vector3d>& path_W, double clearance);

}  // namespace thalweg::explorer
