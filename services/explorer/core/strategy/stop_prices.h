#pragma once

#include <cstddef>
#include <vector>

#include "services/explorer/core/strategy/cover_stops.h"

namespace thalweg::explorer {

/// What it costs to go to a stop and to look from there, as a length of path [m].
///
/// Where only the path counts, that is its length. Where time counts (Situation::time), it is what the robot
/// travels at its usual speed in the time of the way, from rest to rest, or of the turn to the view if that
/// takes longer, because the robot turns while it travels. Only in narrow passages it faces its way: to a
/// stop in one it turns to the way and then to the view. A robot that must face where it moves does so
/// everywhere, and stands while it turns. The stop of a zone costs what is flown there besides,
/// half on arrival and half when leaving.
/// Keeps references.
class StopPrices {
 public:
  StopPrices(const Situation& situation, const std::vector<CoverStop>& stops);

  double FromRobot(std::size_t stop) const;
  /// @param length  [m] The path's. @return The mean of both directions.
  double Between(std::size_t a, std::size_t b, double length) const;

 private:
  struct Pose {
    Eigen::Vector3d p_W;
    Eigen::Matrix3d R_WB;
  };
  Pose PoseAt(std::size_t stop) const;
  double WayFromRobot(std::size_t stop) const;
  double WayBetween(std::size_t a, std::size_t b, double length) const;
  double Within(std::size_t stop) const;  ///< [m] What is flown in a zone, so that the stop stands for it.
  double Time(const Pose& from, const Pose& to, double travel, bool faced) const;

  const Situation& situation_;
  const std::vector<CoverStop>& stops_;
  std::vector<bool> faced_;    ///< For each stop, whether the way to it is; empty where only the path counts.
  double longest_turn_ = 0.0;  ///< [s]
};

}  // namespace thalweg::explorer
