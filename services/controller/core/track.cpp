#include "services/controller/core/track.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/check.h"
#include "common/geometry/polyline.h"

namespace thalweg::controller {
namespace {

constexpr double kSamePlace = 1e-9;  // [m]

/// [m] A robot that must face where it moves begins to turn at most so far before a corner.
constexpr double kFarthestTurn = 0.15;

double TurningDistanceBetween(double before, double after) {
  return std::min(0.5 * std::min(before, after), kFarthestTurn);
}

double AngleBetween(const Eigen::Vector3d& before, const Eigen::Vector3d& after) {
  return std::atan2(before.cross(after).norm(), before.dot(after));
}

/// [m] How much of the track a vertex stands for, if it belongs to a curve. The first segment may be what is
/// left of a longer one.
double LengthOf(const Eigen::Vector3d& before, const Eigen::Vector3d& after, bool is_first) {
  const double mean = 0.5 * (before.norm() + after.norm());
  return is_first ? std::max(mean, after.norm()) : mean;
}

/// @param h  [m] See LengthOf.
double CornerSpeed(const Eigen::Vector3d& before, const Eigen::Vector3d& after, double h,
                   const TrackLimits& limits) {
  const double angle = AngleBetween(before, after);
  if (angle < 1e-9) return limits.max_speed;
  const double speed = std::min({limits.max_speed, limits.corner_step / (2.0 * std::sin(0.5 * angle)),
                                 std::sqrt(limits.max_acceleration * h / angle)});
  if (limits.facing_turn_rate == 0.0) return speed;
  if (angle > kSharpestInCurves) return 0.0;
  const double turning = 2.0 * TurningDistanceBetween(before.norm(), after.norm());
  return std::min(speed, 0.5 * limits.facing_turn_rate * turning / angle);
}

/// What is left along a track of the acceleration `a` beside `lateral` across it [m/s^2].
double Beside(double lateral, double a) {
  return std::sqrt(std::max(0.0, a * a - lateral * lateral));
}

/// The square of the highest speed u from which a robot can brake, over the distance `left`, to a speed whose
/// square is `next`, while its lateral acceleration is at most curvature u:
///   (u - next)^2 = 4 left^2 (a^2 - curvature^2 u^2)
/// If even `next` is more than the curve allows, what that allows.
double BrakesFrom(double next, double curvature, double left, double a) {
  if (curvature * next >= a) return a / curvature;
  const double k = 2.0 * left * curvature;
  const double root = std::sqrt((1.0 + k * k) * 4.0 * left * left * a * a - k * k * next * next);
  return (next + root) / (1.0 + k * k);
}

}  // namespace

Track::Track(const std::vector<RigidTransform>& T_WBs, const TrackLimits& limits) : limits_(limits) {
  THALWEG_CHECK(!T_WBs.empty());
  for (const RigidTransform& T_WB : T_WBs) {
    const Eigen::Quaterniond orientation(T_WB.linear());
    if (!points_.empty() && (T_WB.translation() - points_.back()).norm() < kSamePlace) {
      orientations_.back() = orientation;
      continue;
    }
    arc_.push_back(points_.empty() ? 0.0 : arc_.back() + (T_WB.translation() - points_.back()).norm());
    points_.push_back(T_WB.translation());
    orientations_.push_back(orientation);
  }
  allowed_.assign(points_.size(), limits.max_speed);
  allowed_.back() = 0.0;
  curvature_.assign(points_.size(), 0.0);
  for (std::size_t i = points_.size() - 1; i-- > 0;) {
    const double left = arc_[i + 1] - arc_[i];
    if (i > 0) {
      const Eigen::Vector3d before = points_[i] - points_[i - 1];
      const Eigen::Vector3d after = points_[i + 1] - points_[i];
      const double h = LengthOf(before, after, i == 1);
      allowed_[i] = CornerSpeed(before, after, h, limits);
      curvature_[i] = AngleBetween(before, after) / h;
    }
    const double next = allowed_[i + 1] * allowed_[i + 1];
    const double by_next = next + 2.0 * Beside(next * curvature_[i + 1], limits.max_acceleration) * left;
    const double by_own = BrakesFrom(next, curvature_[i], left, limits.max_acceleration);
    allowed_[i] = std::min(allowed_[i], std::sqrt(std::min(by_next, by_own)));
  }
  for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
    if (allowed_[i] == 0.0) stops_.push_back(arc_[i]);
  }
  stops_.push_back(length());
}

std::size_t Track::SegmentAt(double s) const {
  const auto after = std::upper_bound(arc_.begin(), arc_.end(), s);
  const auto index = static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, after - arc_.begin()));
  return std::min(index - 1, points_.size() < 2 ? 0 : points_.size() - 2);
}

Eigen::Vector3d Track::PositionAt(double s) const {
  if (points_.size() < 2) return points_.front();
  const std::size_t i = SegmentAt(s);
  return points_[i] + ShareOf(i, s) * (points_[i + 1] - points_[i]);
}

Eigen::Vector3d Track::DirectionAt(double s) const {
  if (points_.size() < 2) return Eigen::Vector3d::Zero();
  return SegmentDirection(SegmentAt(s));
}

Eigen::Vector3d Track::SegmentDirection(std::size_t i) const {
  return (points_[i + 1] - points_[i]).normalized();
}

double Track::ShareOf(std::size_t segment, double s) const {
  return std::clamp((s - arc_[segment]) / (arc_[segment + 1] - arc_[segment]), 0.0, 1.0);
}

Eigen::Quaterniond Track::OrientationAt(double s) const {
  if (points_.size() < 2) return orientations_.front();
  const std::size_t i = SegmentAt(s);
  return orientations_[i].slerp(ShareOf(i, s), orientations_[i + 1]).normalized();
}

bool Track::LeadsBackAt(double s) const {
  return DirectionAt(s).dot(OrientationAt(s) * Eigen::Vector3d::UnitX()) < 0.0;
}

double Track::TurningDistance(std::size_t vertex) const {
  return TurningDistanceBetween(arc_[vertex] - arc_[vertex - 1], arc_[vertex + 1] - arc_[vertex]);
}

Eigen::Vector3d Track::FacingAt(double s) const {
  if (points_.size() < 2) return Eigen::Vector3d::Zero();
  const std::size_t i = SegmentAt(s);
  const Eigen::Vector3d along = SegmentDirection(i);
  const auto between = [&](std::size_t vertex, const Eigen::Vector3d& other, double distance) {
    const double share = 0.5 * std::max(0.0, 1.0 - distance / TurningDistance(vertex));
    return Eigen::Vector3d(((1.0 - share) * along + share * other).normalized());
  };
  const bool nearer_to_end = arc_[i + 1] - s < s - arc_[i];
  if (nearer_to_end && i + 2 < points_.size() && allowed_[i + 1] > 0.0)
    return between(i + 1, SegmentDirection(i + 1), arc_[i + 1] - s);
  if (!nearer_to_end && i > 0 && allowed_[i] > 0.0) return between(i, SegmentDirection(i - 1), s - arc_[i]);
  return along;
}

const Eigen::Quaterniond& Track::OrientationAhead(double s) const {
  return orientations_[std::min(SegmentAt(s) + 1, orientations_.size() - 1)];
}

/// [m/s^2] Across the track in the curve that a vertex belongs to, for a robot that may be slower there.
double Track::LateralAt(std::size_t vertex, double speed) const {
  const double slower = std::min(speed, allowed_[vertex]);
  return slower * slower * curvature_[vertex];
}

/// [m/s^2] With which a robot may gain or lose speed in a segment.
double Track::AlongIn(std::size_t segment, double speed) const {
  return Beside(std::max(LateralAt(segment, speed), LateralAt(segment + 1, speed)), limits_.max_acceleration);
}

double Track::SpeedLimitAt(double s) const {
  if (points_.size() < 2) return 0.0;
  const std::size_t segment = SegmentAt(s);
  const double next = allowed_[segment + 1];
  const double left = std::max(0.0, arc_[segment + 1] - s);
  const double brakes = AlongIn(segment, limits_.max_speed);
  return std::min(limits_.max_speed, std::sqrt(next * next + 2.0 * brakes * left));
}

double Track::NextSpeed(double s, double speed, double dt) const {
  if (points_.size() < 2) return 0.0;
  const std::size_t segment = SegmentAt(s);
  double next = std::min(limits_.max_speed, speed + AlongIn(segment, speed) * dt);
  const double reach = s + 0.5 * (speed + next) * dt;
  for (std::size_t i = segment + 1; i < points_.size(); ++i) {
    // The step covers (speed + next) dt / 2. Braking from its end must still reach the speed allowed at
    // vertex i:
    //   next^2 <= allowed^2 + 2 a (left - (speed + next) dt / 2)
    const double a = AlongIn(i - 1, limits_.max_speed);
    const double c = allowed_[i] * allowed_[i] + 2.0 * a * (arc_[i] - s) - a * speed * dt;
    const double half = 0.5 * a * dt;
    const double by_braking = half * half + c > 0.0 ? std::sqrt(half * half + c) - half : 0.0;
    next = std::min(next, std::max(by_braking, allowed_[i]));
    if (arc_[i] > reach) break;  // this vertex's allowed speed already accounts for later ones
  }
  return std::max({next, speed - limits_.max_acceleration * dt, 0.0});
}

double Track::NextStop(double s) const {
  const auto next = std::ranges::upper_bound(stops_, s);
  return next == stops_.end() ? stops_.back() : *next;
}

Track::Nearest Track::NearestTo(const Eigen::Vector3d& p_W, double s_from, double s_to) const {
  s_from = std::clamp(s_from, 0.0, length());
  s_to = std::clamp(s_to, s_from, length());
  Nearest nearest{.s = s_from, .distance = (PositionAt(s_from) - p_W).norm()};
  if (points_.size() < 2) return nearest;
  for (std::size_t i = SegmentAt(s_from); i + 1 < points_.size() && arc_[i] < s_to; ++i) {
    const double begin = std::max(arc_[i], s_from);
    const double end = std::min(arc_[i + 1], s_to);
    const double s = begin + NearestShare(PositionAt(begin), PositionAt(end), p_W) * (end - begin);
    const double distance = (PositionAt(s) - p_W).norm();
    if (distance < nearest.distance) nearest = {.s = s, .distance = distance};
  }
  return nearest;
}

bool Track::Cuts(const Eigen::Vector3d& p_W, double s_from, double s_to, double most) const {
  const Eigen::Vector3d to_W = PositionAt(s_to);
  for (std::size_t i = SegmentAt(s_from) + 1; i < points_.size() && arc_[i] < s_to; ++i) {
    if (DistanceToSegment(p_W, to_W, points_[i]) > most) return true;
  }
  return false;
}

double Track::ReachWithoutCutting(const Eigen::Vector3d& p_W, double s_from, double s, double s_to,
                                  double most) const {
  constexpr double kStep = 0.01;  // [m]
  double reach = s;
  while (reach < s_to && !Cuts(p_W, s_from, std::min(reach + kStep, s_to), most)) {
    reach = std::min(reach + kStep, s_to);
  }
  return reach;
}

namespace {

/// A point on a path, in the segment that starts at vertex `segment`.
struct Foot {
  std::size_t segment = 0;
  Eigen::Vector3d point;
  double offset = 0.0;  ///< [m] Distance from the query point.
};

/// Finds the nearest point of a path, where a meter of arc length costs as much as 5 cm of distance: a path
/// that passes here a second time is joined at its first pass.
Foot FindFoot(const Eigen::Vector3d& p_W, const std::vector<RigidTransform>& path) {
  constexpr double kWeightOfArc = 0.05;
  Foot best{
      .segment = 0, .point = path.front().translation(), .offset = (path.front().translation() - p_W).norm()};
  double best_score = best.offset;
  double arc = 0.0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Eigen::Vector3d a = path[i].translation();
    const Eigen::Vector3d b = path[i + 1].translation();
    const double share = NearestShare(a, b, p_W);
    const Eigen::Vector3d point = a + share * (b - a);
    const double offset = (point - p_W).norm();
    const double length = (b - a).norm();
    const double score = offset + kWeightOfArc * (arc + share * length);
    if (score < best_score) {
      best_score = score;
      best = {.segment = i, .point = point, .offset = offset};
    }
    arc += length;
  }
  return best;
}

/// Moves `ahead` meters farther along the path. Returns nothing when the straight line from there to p_W
/// would cut a corner by more than the foot's offset.
std::optional<Foot> MoveAhead(const Eigen::Vector3d& p_W, const Foot& foot,
                              const std::vector<RigidTransform>& path, double ahead) {
  Foot to = foot;
  while (to.segment + 1 < path.size()) {
    const Eigen::Vector3d next = path[to.segment + 1].translation();
    const double left = (next - to.point).norm();
    if (left >= ahead) {
      to.point += (next - to.point) * (left > 0.0 ? ahead / left : 0.0);
      break;
    }
    ahead -= left;
    to.point = next;
    ++to.segment;
  }
  for (std::size_t i = foot.segment + 1; i <= to.segment; ++i) {
    if (DistanceToSegment(p_W, to.point, path[i].translation()) > foot.offset) return std::nullopt;
  }
  return to;
}

}  // namespace

std::optional<std::vector<RigidTransform>> JoinPath(const Eigen::Vector3d& p_W,
                                                    const std::vector<RigidTransform>& path,
                                                    double tolerance) {
  THALWEG_CHECK(!path.empty());
  const Foot foot = FindFoot(p_W, path);
  if (foot.offset > tolerance) return std::nullopt;
  Foot entry = foot;
  for (double share = 6.0; share > 0.5; share *= 0.5) {
    if (const auto ahead = MoveAhead(p_W, foot, path, share * foot.offset)) {
      entry = *ahead;
      break;
    }
  }
  const std::size_t next = std::min(entry.segment + 1, path.size() - 1);
  const Eigen::Matrix3d R_WB = path[next].linear();
  std::vector<RigidTransform> rest{MakeTransform(R_WB, p_W), MakeTransform(R_WB, entry.point)};
  rest.insert(rest.end(), path.begin() + static_cast<std::ptrdiff_t>(next), path.end());
  return rest;
}

std::optional<std::vector<RigidTransform>> RestOfPath(const Eigen::Vector3d& p_W,
                                                      const std::vector<RigidTransform>& path,
                                                      double tolerance) {
  THALWEG_CHECK(!path.empty());
  const Foot foot = FindFoot(p_W, path);
  if (foot.offset > tolerance) return std::nullopt;
  const std::size_t next = std::min(foot.segment + 1, path.size() - 1);
  const RigidTransform& from = path[foot.segment];
  const double share = NearestShare(from.translation(), path[next].translation(), foot.point);
  std::vector<RigidTransform> rest{Interpolate(from, path[next], share)};
  rest.insert(rest.end(), path.begin() + static_cast<std::ptrdiff_t>(next), path.end());
  return rest;
}

}  // namespace thalweg::controller
