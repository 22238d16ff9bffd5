#include "services/explorer/core/path/motion_times.h"

#include <cmath>

namespace thalweg::explorer {
namespace {

constexpr double kUsualSpeed = 0.5;  // of the greatest

/// [s] For a way from rest to rest, by the greatest rate and its greatest change.
double Trapezoid(double way, double rate, double acceleration) {
  return way * acceleration < rate * rate ? 2.0 * std::sqrt(way / acceleration)
                                          : way / rate + rate / acceleration;
}

}  // namespace

double TravelTime(double length, const RobotModel& robot) {
  return Trapezoid(length, robot.max_speed, robot.max_acceleration);
}

double TurnTime(double angle, const RobotModel& robot) {
  return Trapezoid(angle, robot.max_turn_rate, robot.max_turn_acceleration);
}

double UsualPath(double time, const RobotModel& robot) {
  return time * kUsualSpeed * robot.max_speed;
}

}  // namespace thalweg::explorer
