#include "services/explorer/core/path/flyable_path.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/polyline.h"

namespace thalweg::explorer {
namespace {

using Obstacles = PlanningMap::Obstacles;

constexpr double kStep = 0.15;      // [m] between the points that are moved
constexpr int kRounds = 40;         // of moving each point
constexpr double kReach = 0.5;      // [m] farthest that a point is moved
constexpr int kCuts = 3;            // of all corners: each halves the angle
constexpr double kStraight = 0.01;  // [rad] A corner of less is none.

double CornerAt(const Eigen::Vector3d& before, const Eigen::Vector3d& here, const Eigen::Vector3d& after) {
  const Eigen::Vector3d a = here - before;
  const Eigen::Vector3d b = after - here;
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

std::vector<Eigen::Vector3d> SampledEvery(double step, const std::vector<Eigen::Vector3d>& path_W) {
  std::vector<Eigen::Vector3d> points_W{path_W.front()};
  for (std::size_t n = 1; n < path_W.size(); ++n) {
    ForEachPointAlong(path_W[n - 1], path_W[n], step, [&](const Eigen::Vector3d& p_W) {
      points_W.push_back(p_W);
      return true;
    });
    points_W.back() = path_W[n];  // without rounding
  }
  return points_W;
}

/// Moves each point from the first to the last but one to where the squared second differences are least, in
/// several rounds.
void Relax(const PlanningMap& map, double keep, std::size_t first, std::vector<Eigen::Vector3d>& points_W) {
  const std::vector<Eigen::Vector3d> from_W = points_W;
  std::vector<double> needed(points_W.size());
  for (std::size_t n = 0; n < points_W.size(); ++n) {
    needed[n] = map.ClearanceAt(points_W[n], Obstacles::kOccupiedAndUnknown, keep);
  }
  const std::size_t last = points_W.size() - 1;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t n = first; n < last; ++n) {
      // The terms of the sum that hold point n are the second differences at n - 1, n and n + 1, as far as
      // they exist.
      Eigen::Vector3d sum_W = 2.0 * (points_W[n - 1] + points_W[n + 1]);
      double weight = 4.0;
      if (n > 1) {
        sum_W += 2.0 * points_W[n - 1] - points_W[n - 2];
        weight += 1.0;
      }
      if (n + 1 < last) {
        sum_W += 2.0 * points_W[n + 1] - points_W[n + 2];
        weight += 1.0;
      }
      const Eigen::Vector3d to_W = sum_W / weight;
      if ((to_W - from_W[n]).norm() > kReach) continue;
      if (map.ClearanceAt(to_W, Obstacles::kOccupiedAndUnknown, keep) < needed[n] - 1e-9) continue;
      points_W[n] = to_W;
    }
  }
}

/// Replaces each corner by points a quarter along both of its sides.
std::vector<Eigen::Vector3d> Cut(const std::vector<Eigen::Vector3d>& points_W) {
  std::vector<Eigen::Vector3d> cut_W{points_W.front()};
  for (std::size_t n = 1; n + 1 < points_W.size(); ++n) {
    if (CornerAt(points_W[n - 1], points_W[n], points_W[n + 1]) < kStraight) {
      cut_W.push_back(points_W[n]);
      continue;
    }
    cut_W.push_back(points_W[n] + 0.25 * (points_W[n - 1] - points_W[n]));
    cut_W.push_back(points_W[n] + 0.25 * (points_W[n + 1] - points_W[n]));
  }
  cut_W.push_back(points_W.back());
  return cut_W;
}

bool HasCorners(const std::vector<Eigen::Vector3d>& path_W) {
  for (std::size_t n = 1; n + 1 < path_W.size(); ++n) {
    if (CornerAt(path_W[n - 1], path_W[n], path_W[n + 1]) > kStraight) return true;
  }
  return false;
}

}  // namespace

std::vector<Eigen::Vector3d> MakeFlyable(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W,
                                         double keep, bool moving) {
  if (PathLength(path_W) < 2.0 * kStep || !HasCorners(path_W)) return path_W;
  std::vector<Eigen::Vector3d> points_W = SampledEvery(kStep, path_W);
  Relax(map, keep, moving ? 2 : 1, points_W);
  for (int cut = 0; cut < kCuts; ++cut) points_W = Cut(points_W);
  // Between the points, the body must be as far from everything as on the path.
  double least = map.options().clearance;
  for (std::size_t n = 1; n < path_W.size(); ++n) {
    least = std::min(least,
                     map.SegmentClearance(path_W[n - 1], path_W[n], Obstacles::kOccupiedAndUnknown, least));
  }
  for (std::size_t n = 1; n < points_W.size(); ++n) {
    if (!map.SegmentClear(points_W[n - 1], points_W[n], Obstacles::kOccupiedAndUnknown, least - 1e-6))
      return path_W;
  }
  return points_W;
}

}  // namespace thalweg::explorer
