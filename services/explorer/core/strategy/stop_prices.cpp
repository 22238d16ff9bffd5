#include "services/explorer/core/strategy/stop_prices.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/explorer/core/path/motion_times.h"
#include "services/explorer/core/path/narrow_passage.h"

namespace thalweg::explorer {
namespace {

constexpr double kFromOneToNext = 0.5;  // [m] Between the clusters of a zone.

double AngleOf(double cosine) {
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

}  // namespace

StopPrices::StopPrices(const Situation& situation, const std::vector<CoverStop>& stops)
    : situation_(situation), stops_(stops) {
  if (!situation.time) return;
  const RobotModel& robot = situation.time->model;
  longest_turn_ = TurnTime(std::numbers::pi, robot);
  if (robot.gimballed()) {
    longest_turn_ = TurnTime(RotationFromYawPitch(0.0, robot.gimbal_lowest),
                             RotationFromYawPitch(std::numbers::pi, robot.gimbal_highest), robot);
  }
  for (const CoverStop& stop : stops)
    faced_.push_back(
        situation.time->model.faces_travel() ||
        (!stop.is_here && IsNarrow(situation.map, PositionOf(stop, situation), situation.time->model)));
}

StopPrices::Pose StopPrices::PoseAt(std::size_t stop) const {
  return {PositionOf(stops_[stop], situation_), *stops_[stop].R_WB};
}

double StopPrices::Within(std::size_t stop) const {
  const CoverStop& its = stops_[stop];
  return its.is_zone ? kFromOneToNext * static_cast<double>(its.items.size() - 1) : 0.0;
}

double StopPrices::FromRobot(std::size_t stop) const {
  return WayFromRobot(stop) + 0.5 * Within(stop);
}

double StopPrices::Between(std::size_t a, std::size_t b, double length) const {
  return WayBetween(a, b, length) + 0.5 * (Within(a) + Within(b));
}

double StopPrices::WayFromRobot(std::size_t stop) const {
  const double length = stops_[stop].is_here ? 0.0 : situation_.search.Length(stops_[stop].place);
  if (!situation_.time) return length;
  const auto& [robot, R_WB] = *situation_.time;
  return UsualPath(Time({situation_.robot_W, R_WB}, PoseAt(stop), TravelTime(length, robot), faced_[stop]),
                   robot);
}

double StopPrices::WayBetween(std::size_t a, std::size_t b, double length) const {
  if (!situation_.time) return length;
  const RobotModel& robot = situation_.time->model;
  const double travel = TravelTime(length, robot);
  const bool faced = faced_[a] || faced_[b];
  if (!robot.faces_travel() && travel >= (faced ? 2.0 : 1.0) * longest_turn_) return UsualPath(travel, robot);
  const Pose its_a = PoseAt(a);
  const Pose its_b = PoseAt(b);
  const double there = Time(its_a, its_b, travel, faced_[b]);
  const double back = faced ? Time(its_b, its_a, travel, faced_[a]) : there;
  return UsualPath(0.5 * (there + back), robot);
}

/// [s] @param travel  [s]
double StopPrices::Time(const Pose& from, const Pose& to, double travel, bool faced) const {
  const RobotModel& robot = situation_.time->model;
  Eigen::Vector3d way_W = to.p_W - from.p_W;
  if (robot.level()) way_W.z() = 0.0;
  if (!faced || way_W.norm() < situation_.map.voxel_size())
    return std::max(travel, TurnTime(from.R_WB, to.R_WB, robot));
  way_W.normalize();
  const double turns = TurnTime(AngleOf(way_W.dot(from.R_WB.col(0))), robot) +
                       TurnTime(AngleOf(way_W.dot(to.R_WB.col(0))), robot);
  return robot.faces_travel() ? travel + turns : std::max(travel, turns);
}

}  // namespace thalweg::explorer
