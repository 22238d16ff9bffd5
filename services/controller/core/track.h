#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "common/geometry/rigid_transform.h"

namespace thalweg::controller {

/// How fast a track may be travelled.
struct TrackLimits {
  double max_speed = 0.5;         ///< [m/s]
  double max_acceleration = 1.0;  ///< [m/s^2] Along the track, and across it where the track is a fine curve.
  double corner_step = 0.05;      ///< [m/s] Largest change of the velocity vector at a single corner.
};

/// A polyline in W, measured by arc length, with the speed at which each of its corners may be taken.
///
/// A corner of angle t changes the velocity by 2 v sin(t / 2) at once, because the polyline is followed
/// exactly; so v <= corner_step / (2 sin(t / 2)). Fine polylines stand for curves; there the mean lateral
/// acceleration v^2 t / h, h being the mean length of the two segments, is limited as well.
/// The speed allowed at each vertex also lets every later one be met by braking.
class Track {
 public:
  /// @param T_WBs  At least one. Vertices at the same place become one, with the last one's orientation.
  Track(const std::vector<RigidTransform>& T_WBs, const TrackLimits& limits);

  double length() const { return arc_.back(); }  ///< [m]
  const Eigen::Vector3d& end() const { return points_.back(); }
  const Eigen::Quaterniond& end_orientation() const { return orientations_.back(); }

  Eigen::Vector3d PositionAt(double s) const;
  /// Unit length; zero where the track is a single point.
  Eigen::Vector3d DirectionAt(double s) const;
  /// R_WB that the next vertex asks for; beyond the last vertex, that of the last.
  const Eigen::Quaterniond& OrientationAhead(double s) const;

  /// Highest speed at `s` from which all that comes can still be met by braking.
  double SpeedLimitAt(double s) const;
  /// Highest speed at the end of a step of `dt` [s] that starts at `s` with `speed`; within the acceleration.
  double NextSpeed(double s, double speed, double dt) const;

  /// From p_W to the part of the track between the two arc lengths, [m].
  double DistanceTo(const Eigen::Vector3d& p_W, double s_from, double s_to) const;

 private:
  std::size_t SegmentAt(double s) const;  ///< Index of its first vertex.

  TrackLimits limits_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Eigen::Quaterniond> orientations_;
  std::vector<double> arc_;      ///< Of each vertex, from the start.
  std::vector<double> allowed_;  ///< [m/s] at each vertex.
};

/// What is left of a path for somebody who is at `p_W`: a first waypoint there, a short straight way onto the
/// path, and the path from there on. The way in leads a little ahead, so that a small offset is no sharp
/// corner, but never further from the path than the offset.
/// @return Nothing when the path is further away than `tolerance`.
std::optional<std::vector<RigidTransform>> JoinPath(const Eigen::Vector3d& p_W,
                                                    const std::vector<RigidTransform>& path,
                                                    double tolerance);

}  // namespace thalweg::controller
