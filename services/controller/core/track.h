#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "common/geometry/rigid_transform.h"
#include "common/geometry/robot_model.h"

namespace thalweg::controller {

/// Limits on the speed along a track.
struct TrackLimits {
  double max_speed = RobotModel{}.max_speed;  ///< [m/s]
  /// [m/s^2] Along the track, and across it where it stands for a curve, together.
  double max_acceleration = RobotModel{}.max_acceleration;
  double corner_step = 0.05;  ///< [m/s] Largest change of the velocity vector at a single corner.
  /// [rad/s] For a robot that must face where it moves, the rate at which it turns; 0 = any other robot.
  double facing_turn_rate = 0.0;
};

/// [rad] A robot that must face where it moves stands still to turn at corners sharper than this; others
/// belong to curves.
inline constexpr double kSharpestInCurves = 0.2;

/// A polyline in W, parameterized by arc length, with the highest speed allowed at each vertex.
///
/// Because the polyline is followed exactly, a corner of angle t changes the velocity instantly by 2 v sin(t
/// / 2); hence v <= corner_step / (2 sin(t / 2)). Since fine polylines stand for curves, the mean lateral
/// acceleration v^2 t / h is limited as well, where h is the mean length of the two segments, and on these
/// segments there is only what it leaves of the acceleration for gaining and losing speed:
///   a_along^2 + (v^2 t / h)^2 <= a^2
/// The speed allowed at a vertex is also low enough to brake in time for every later vertex. A robot that
/// must face where it moves stops at sharp corners. It turns at other corners from a distance b before to b
/// behind them, at v t / (2 b), which is at most half the rate at which it can turn: the turn itself takes
/// time to begin.
class Track {
 public:
  /// @param T_WBs  At least one. Vertices at the same position are merged and take the last one's
  /// orientation.
  Track(const std::vector<RigidTransform>& T_WBs, const TrackLimits& limits);

  double length() const { return arc_.back(); }  ///< [m]
  const Eigen::Vector3d& end() const { return points_.back(); }
  const Eigen::Quaterniond& end_orientation() const { return orientations_.back(); }

  Eigen::Vector3d PositionAt(double s) const;
  /// Unit length; zero when the track is a single point.
  Eigen::Vector3d DirectionAt(double s) const;
  /// The direction that a robot faces which must face where it moves: that of the segment, and near a corner
  /// at which it does not stop, between those of both. Unit length; zero when the track is a single point.
  Eigen::Vector3d FacingAt(double s) const;
  /// R_WB between those of the vertices before and after.
  Eigen::Quaterniond OrientationAt(double s) const;
  /// Whether the orientations there look away from where the track leads.
  bool LeadsBackAt(double s) const;
  /// R_WB at the next vertex; beyond the last vertex, that of the last.
  const Eigen::Quaterniond& OrientationAhead(double s) const;

  /// Highest speed at `s` from which the robot can brake in time for everything ahead.
  double SpeedLimitAt(double s) const;
  /// Highest speed at the end of a step of `dt` [s] that starts at `s` with `speed`, within the acceleration
  /// limit.
  double NextSpeed(double s, double speed, double dt) const;

  /// [m] Arc length of the first vertex beyond `s` at which the robot stops: a sharp corner, or the end.
  double NextStop(double s) const;

  /// The point of the part of the track between two arc lengths that is nearest to a position.
  struct Nearest {
    double s = 0.0;         ///< [m]
    double distance = 0.0;  ///< [m]
  };
  Nearest NearestTo(const Eigen::Vector3d& p_W, double s_from, double s_to) const;

  /// How far a pose command may go for a robot that moves straight to it: [m] the arc length from `s` to at
  /// most `s_to`, which may lie beyond the end, up to which the straight line from p_W leaves out no vertex
  /// beyond `s_from` by more than `most` [m]; `s` itself if the line to there does.
  double ReachWithoutCutting(const Eigen::Vector3d& p_W, double s_from, double s, double s_to,
                             double most) const;

 private:
  std::size_t SegmentAt(double s) const;  ///< Index of the segment's first vertex.
  double ShareOf(std::size_t segment, double s) const;
  Eigen::Vector3d SegmentDirection(std::size_t i) const;
  double TurningDistance(std::size_t vertex) const;
  double LateralAt(std::size_t vertex, double speed) const;
  double AlongIn(std::size_t segment, double speed) const;
  bool Cuts(const Eigen::Vector3d& p_W, double s_from, double s_to, double most) const;

  TrackLimits limits_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Eigen::Quaterniond> orientations_;
  std::vector<double> arc_;        ///< [m] Arc length of each vertex from the start.
  std::vector<double> curvature_;  ///< [1/m] at each vertex, if it belongs to a curve.
  std::vector<double> allowed_;    ///< [m/s] at each vertex.
  std::vector<double> stops_;  ///< [m] Arc lengths at which the robot stops, increasing; the last is the end.
};

/// The remaining path for a robot at `p_W`: a first waypoint there, a short straight connection onto the
/// path, and the path from there on. The connection meets the path a little ahead, so that a small offset
/// makes no sharp corner, but it never strays farther from the path than the offset.
/// @param path  Not empty. @return Two poses or more; empty when the path is farther away than `tolerance`.
std::optional<std::vector<RigidTransform>> JoinPath(const Eigen::Vector3d& p_W,
                                                    const std::vector<RigidTransform>& path,
                                                    double tolerance);

/// The same without a connection: from the path's nearest point on, for a robot that steers onto it.
/// @return  One pose or more.
std::optional<std::vector<RigidTransform>> RestOfPath(const Eigen::Vector3d& p_W,
                                                      const std::vector<RigidTransform>& path,
                                                      double tolerance);

}  // namespace thalweg::controller
