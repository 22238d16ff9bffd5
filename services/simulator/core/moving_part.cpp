#include "services/simulator/core/moving_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/check.h"
#include "services/simulator/core/upright_cylinder.h"

namespace thalweg::simulator {
namespace {

constexpr double kBetweenLooks = 0.01;  // [m] Between two looks at whether the robot is in the way.
constexpr double kRounding = 1e-9;      // [m] A part that passes by comes no nearer than this.

using Place = MovingPart::Place;

Place Between(const Place& from, const Place& to, double share) {
  return {.time = from.time + share * (to.time - from.time),
          .yaw = from.yaw + share * (to.yaw - from.yaw),
          .offset_W = from.offset_W + share * (to.offset_W - from.offset_W)};
}

/// The places of one round of the timetable; with a period, the first follows the last once more.
std::vector<Place> RoundOf(const MovingPart& part) {
  std::vector<Place> round = part.places;
  if (part.period > 0.0 && !round.empty()) {
    round.push_back(part.places.front());
    round.back().time += part.period;
  }
  return round;
}

Place PlaceAt(const MovingPart& part, double time) {
  if (part.places.empty()) return {};
  const Place& first = part.places.front();
  if (part.period > 0.0) {  // into the round that begins with the first place
    time = first.time + std::fmod(time - first.time, part.period);
    if (time < first.time) time += part.period;
  }
  const std::vector<Place> round = RoundOf(part);
  const auto next = std::ranges::upper_bound(round, time, {}, &Place::time);
  if (next == round.begin()) return first;
  if (next == round.end()) return round.back();
  const Place& before = *(next - 1);
  return Between(before, *next, (time - before.time) / (next->time - before.time));
}

RigidTransform PoseOf(const MovingPart& part, const Place& place) {
  const Eigen::Matrix3d turn = RotationFromYawPitch(place.yaw, 0.0);
  return MakeTransform(turn, part.pivot_W - turn * part.pivot_W + place.offset_W);
}

/// [m] No point of the part moves farther from one place to another.
double WayBetween(const MovingPart& part, const Place& from, const Place& to) {
  double reach = 0.0;  // of the corner that is farthest from the axis
  for (const double x : {part.at_rest_W.min().x(), part.at_rest_W.max().x()}) {
    for (const double y : {part.at_rest_W.min().y(), part.at_rest_W.max().y()}) {
      reach = std::max(reach, std::hypot(x - part.pivot_W.x(), y - part.pivot_W.y()));
    }
  }
  return std::abs(to.yaw - from.yaw) * reach + (to.offset_W - from.offset_W).norm();
}

}  // namespace

RigidTransform PoseAt(const MovingPart& part, double time) {
  return PoseOf(part, PlaceAt(part, time));
}

double FastestOf(const MovingPart& part) {
  const std::vector<Place> round = RoundOf(part);
  double fastest = 0.0;
  for (std::size_t k = 1; k < round.size(); ++k) {
    const double time = round[k].time - round[k - 1].time;
    if (time > 0.0) fastest = std::max(fastest, WayBetween(part, round[k - 1], round[k]) / time);
  }
  return fastest;
}

void VisitPoses(const MovingPart& part, double step,
                const std::function<void(const RigidTransform&)>& visit) {
  THALWEG_CHECK(step > 0.0);
  visit(PoseAt(part, 0.0));
  const std::vector<Place> round = RoundOf(part);
  for (std::size_t k = 1; k < round.size(); ++k) {
    const double steps = std::ceil(WayBetween(part, round[k - 1], round[k]) / step);
    for (double n = 0.0; n <= steps; ++n) {
      visit(PoseOf(part, Between(round[k - 1], round[k], n / std::max(1.0, steps))));
    }
  }
}

double DistanceTo(const MovingPart& part, const RigidTransform& T_WP, const RobotModel& robot,
                  const Eigen::Vector3d& p_W) {
  const Eigen::Vector3d p_P = T_WP.inverse() * p_W;  // a part turns about the vertical axis only
  if (robot.height > 0.0) return Distance({p_P, robot.radius, robot.height}, part.at_rest_W);
  return part.at_rest_W.exteriorDistance(p_P) - robot.radius;
}

double PartInMotion::Advance(double dt, const RobotModel& robot, const Eigen::Vector3d& p_W) {
  const double fastest = FastestOf(part_);
  const double steps = std::max(1.0, std::ceil(fastest * dt / kBetweenLooks));
  const double begin = clock_;
  double distance = DistanceTo(robot, p_W);
  waits_ = false;
  for (double n = 1.0; n <= steps; ++n) {
    const double next = begin + dt * n / steps;
    const RigidTransform T_WP = PoseAt(part_, next);
    const double next_distance = simulator::DistanceTo(part_, T_WP, robot, p_W);
    waits_ = next_distance < kKeepOff && next_distance < distance - kRounding;
    if (waits_) break;
    clock_ = next;
    T_WP_ = T_WP;
    distance = next_distance;
  }
  return fastest * (clock_ - begin);
}

std::optional<PartInMotion::Meeting> PartInMotion::CastRay(const Eigen::Vector3d& origin_W,
                                                           const Eigen::Vector3d& direction_W,
                                                           double max_distance) const {
  const RigidTransform T_PW = T_WP_.inverse();
  const Eigen::Vector3d origin = T_PW * origin_W;
  const Eigen::Vector3d direction = T_PW.linear() * direction_W;
  double enter = -std::numeric_limits<double>::infinity();
  double leave = std::numeric_limits<double>::infinity();
  int enter_axis = 0;
  int leave_axis = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = part_.at_rest_W.min()[axis] - origin[axis];
    const double high = part_.at_rest_W.max()[axis] - origin[axis];
    const double speed = direction[axis];
    if (speed == 0.0) {
      if (low > 0.0 || high < 0.0) return std::nullopt;
      continue;
    }
    if (const double in = (speed > 0.0 ? low : high) / speed; in > enter) {
      enter = in;
      enter_axis = axis;
    }
    if (const double out = (speed > 0.0 ? high : low) / speed; out < leave) {
      leave = out;
      leave_axis = axis;
    }
  }
  const bool inside = enter < 0.0;
  const double distance = inside ? leave : enter;
  if (enter > leave || distance < 0.0 || distance > max_distance) return std::nullopt;
  const int axis = inside ? leave_axis : enter_axis;
  const Eigen::Vector3d normal = -std::copysign(1.0, direction[axis]) * Eigen::Vector3d::Unit(axis);
  return Meeting{distance, T_WP_.linear() * normal, origin + distance * direction};
}

double PartInMotion::DistanceTo(const Eigen::Vector3d& p_W) const {
  return part_.at_rest_W.exteriorDistance(T_WP_.inverse() * p_W);
}

}  // namespace thalweg::simulator
