#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "common/geometry/rigid_transform.h"

namespace thalweg {

/// The path on which the robot came, so that it can go back on it.
///
/// Kept as a polyline from which no pose of the robot is farther than kTolerance, and on which the robot
/// turns by at most kTurn from one vertex to the next (streaming simplification by an opening window). A pose
/// that leaps away from the one before was not reached by moving: the odometry has corrected itself, or the
/// robot was carried. What was flown before is then forgotten, since the way there is not known.
///
/// Memory: at most kMostPoses vertices; beyond that, the oldest are forgotten.
/// Threading: one thread.
class FlownPath {
 public:
  static constexpr double kTolerance = 0.01;  ///< [m]
  static constexpr double kTurn = 0.2;        ///< [rad]
  static constexpr double kLeap = 0.5;        ///< [m] Farther than a robot moves between two poses.
  static constexpr std::size_t kMostPoses = 20'000;

  /// Appends a pose of the robot. Amortized O(1).
  void Note(const RigidTransform& T_WB);

  bool empty() const { return vertices_.empty(); }
  /// [m] Arc length of the oldest pose that is remembered; above 0 once older ones were forgotten.
  double begin() const { return empty() ? 0.0 : vertices_.front().arc; }
  double end() const;  ///< [m] Arc length of the newest pose.

  /// The poses from the newest back to arc length `arc`, which is clamped. Empty if the path is.
  std::vector<RigidTransform> BackTo(double arc) const;
  /// Forgets the end of the path, because the robot has gone back to arc length `arc`, which is clamped.
  void Shorten(double arc);

  std::size_t size() const { return vertices_.size(); }  ///< Number of vertices.

 private:
  struct Vertex {
    RigidTransform T_WB;
    double arc = 0.0;  ///< [m]
  };
  RigidTransform PoseAt(double arc) const;
  bool StraightTo(const RigidTransform& T_WB) const;
  void Fix(const RigidTransform& T_WB);

  std::deque<Vertex> vertices_;                ///< Oldest first.
  std::vector<Eigen::Vector3d> since_W_;       ///< Positions since the last vertex.
  std::optional<RigidTransform> T_WB_newest_;  ///< Beyond the last vertex.
};

}  // namespace thalweg
