#include "services/explorer/core/path/swing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/base/angles.h"
#include "common/base/check.h"
#include "common/geometry/polyline.h"

namespace thalweg::explorer {
namespace {

constexpr std::array kShares = {1.0, 0.8, 0.6, 0.4, 0.2};  // of the greatest speed, after the swing
constexpr std::size_t kFarthest = 6;                       // vertex of the path that is flown to
constexpr double kSpared = 0.9;         // of the acceleration, since a polyline is no parabola
constexpr double kVelocityStep = 0.03;  // [m/s] between points, which the controller takes in full flight
const double kSharpest = std::cos(120.0 * kDegree);  // Who turns by more almost stands in between.
constexpr double kLeastStraight = 0.05;              // [m]
constexpr double kSame = 1e-3;                       // [m]
constexpr int kRounds = 30;                          // of finding the direction of the straight flight

struct Parabola {
  Eigen::Vector3d end_W;
  Eigen::Vector3d v_end_W;
  double duration = 0.0;  // [s]
};

Parabola ParabolaTo(const Flight& flight, const Eigen::Vector3d& v_W, double acceleration) {
  const double duration = (v_W - flight.v_W).norm() / acceleration;
  return {flight.p_W + 0.5 * duration * (flight.v_W + v_W), v_W, duration};
}

/// The parabola at whose end the robot flies at `speed` straight to the goal; empty when there is none.
std::optional<Parabola> ParabolaToward(const Flight& flight, const Eigen::Vector3d& goal_W, double speed,
                                       double acceleration) {
  Eigen::Vector3d from_W = flight.p_W;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Vector3d way_W = goal_W - from_W;
    if (way_W.norm() < kLeastStraight) return std::nullopt;
    const Parabola parabola = ParabolaTo(flight, speed * way_W.normalized(), acceleration);
    if ((parabola.end_W - from_W).norm() < kSame)
      return way_W.normalized().dot(flight.v_W.normalized()) > kSharpest ? std::optional(parabola)
                                                                         : std::nullopt;
    from_W = parabola.end_W;
  }
  return std::nullopt;
}

/// [s] For a straight flight that begins at `speed`, at the end of which the robot stands, or not. Empty when
/// it cannot stop in time.
std::optional<double> TimeOfStraight(double length, double speed, bool stands, const Flight& flight) {
  const double a = flight.max_acceleration;
  if (!stands) {
    const double gaining = std::min(length, 0.5 * (flight.max_speed * flight.max_speed - speed * speed) / a);
    const double reached = std::sqrt(speed * speed + 2.0 * a * gaining);
    return (reached - speed) / a + (length - gaining) / flight.max_speed;
  }
  if (speed * speed > 2.0 * a * length) return std::nullopt;
  const double top = std::min(flight.max_speed, std::sqrt(0.5 * speed * speed + a * length));
  const double changing = (top * top - 0.5 * speed * speed) / a;  // [m] gaining speed and losing it
  return (2.0 * top - speed) / a + (length - changing) / top;
}

std::vector<Eigen::Vector3d> PointsOf(const Flight& flight, const Parabola& parabola) {
  const double change = (parabola.v_end_W - flight.v_W).norm();
  const int steps = std::max(1, static_cast<int>(std::ceil(change / kVelocityStep)));
  std::vector<Eigen::Vector3d> points_W{flight.p_W};
  for (int n = 1; n <= steps; ++n) {
    const double share = static_cast<double>(n) / steps;
    const Eigen::Vector3d v_mean_W = flight.v_W + 0.5 * share * (parabola.v_end_W - flight.v_W);
    const Eigen::Vector3d p_W = flight.p_W + share * parabola.duration * v_mean_W;
    if ((p_W - points_W.back()).norm() > kSame) points_W.push_back(p_W);
  }
  return points_W;
}

bool Clear(const PlanningMap& map, const std::vector<Eigen::Vector3d>& points_W, double clearance) {
  for (std::size_t n = 1; n < points_W.size(); ++n) {
    if (!map.SegmentClear(points_W[n - 1], points_W[n], PlanningMap::Obstacles::kOccupiedAndUnknown,
                          clearance))
      return false;
  }
  return true;
}

}  // namespace

std::optional<Swing> SwingOnto(const PlanningMap& map, const Flight& flight,
                               const std::vector<Eigen::Vector3d>& path_W, double clearance) {
  THALWEG_CHECK(path_W.size() >= 2);
  struct Way {
    Parabola parabola;
    std::size_t vertex;
    double time;  // [s]
  };
  std::vector<Way> ways;
  const std::size_t last = path_W.size() - 1;
  for (std::size_t vertex = 1; vertex <= std::min(last, kFarthest); ++vertex) {
    const double rest = PathLength({path_W.begin() + static_cast<std::ptrdiff_t>(vertex), path_W.end()});
    for (const double share : kShares) {
      const double speed = share * flight.max_speed;
      const std::optional<Parabola> parabola =
          ParabolaToward(flight, path_W[vertex], speed, kSpared * flight.max_acceleration);
      if (!parabola) continue;
      const std::optional<double> straight =
          TimeOfStraight((path_W[vertex] - parabola->end_W).norm(), speed, vertex == last, flight);
      if (straight)
        ways.push_back({*parabola, vertex, parabola->duration + *straight + rest / flight.max_speed});
    }
  }
  std::ranges::stable_sort(ways, {}, &Way::time);
  for (const Way& way : ways) {
    std::vector<Eigen::Vector3d> arc_W = PointsOf(flight, way.parabola);
    if (!map.SegmentClear(arc_W.back(), path_W[way.vertex], PlanningMap::Obstacles::kOccupiedAndUnknown,
                          clearance) ||
        !Clear(map, arc_W, clearance))
      continue;
    return Swing{.arc_W = std::move(arc_W),
                 .rest_W = {path_W.begin() + static_cast<std::ptrdiff_t>(way.vertex), path_W.end()}};
  }
  return std::nullopt;
}

}  // namespace thalweg::explorer
