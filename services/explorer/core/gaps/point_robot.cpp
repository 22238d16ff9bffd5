#include "services/explorer/core/gaps/point_robot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "common/base/angles.h"

namespace thalweg::explorer {
namespace {

using Eigen::Vector2d;

constexpr double kChord = 10.0 * kDegree;
constexpr std::size_t kMostLegsAtAVertex = 64;  ///< More than a full turn around it.

/// The share of the way from a to b at which it crosses a ray; none where it does not.
std::optional<double> ShareAtCrossing(const CriticalRay& ray, const Vector2d& a, const Vector2d& b) {
  const double at_a = ray.Depth(a);
  const double at_b = ray.Depth(b);
  if ((at_a > 0.0) == (at_b > 0.0)) return std::nullopt;
  const double at_start = Cross(b - a, ray.start - a);
  const double at_end = Cross(b - a, ray.end - a);
  if ((at_start > 0.0) == (at_end > 0.0)) return std::nullopt;
  return at_a / (at_a - at_b);
}

double DirectionTo(const Vector2d& from, const Vector2d& to) {
  return std::atan2(to.y() - from.y(), to.x() - from.x());
}

/// How far to turn left from one direction to the other, in [0, 2 pi).
double LeftTurn(double from, double to) {
  const double turn = to - from;
  return turn < 0.0 ? turn + 2.0 * std::numbers::pi : turn;
}

}  // namespace

PointRobot::PointRobot(const Polygon& polygon, const Vector2d& start, const Options& options)
    : polygon_(polygon),
      options_(options),
      rays_(CriticalRays(polygon)),
      path_{start},
      smallest_step_(std::numeric_limits<double>::infinity()) {
  if (!polygon.Contains(start)) throw std::invalid_argument("the robot's start is not inside the polygon");
  for (const Gap& gap : SenseGaps(polygon, start)) gaps_.push_back(gap.vertex);
}

GapEvent PointRobot::Chase(std::size_t slot) {
  for (std::size_t leg = 0; leg < kMostLegsAtAVertex * polygon_.size(); ++leg) {
    const std::size_t vertex = gaps_.at(slot);
    const double clearance = ClearanceAt(vertex);
    const Vector2d away = position() - polygon_[vertex];
    // Rounding keeps the distance that the robot has, which may be less where it passed the vertex before.
    Vector2d next = polygon_[vertex] + clearance / away.norm() * away;
    if (away.norm() <= (1.0 + 1e-6) * clearance) {
      const bool left = HiddenSide(polygon_, position(), vertex) == GapSide::kLeft;
      next = polygon_[vertex] + Turned(away, left ? kChord : -kChord);
    }
    const CriticalRay* const crossed = Move(next, clearance / 2.0);
    if (crossed == nullptr) continue;
    if (const auto event = Update(*crossed)) return *event;
  }
  throw std::runtime_error("no event came from chasing a gap: the polygon is not in general position");
}

std::optional<GapEvent> PointRobot::MoveTowards(const Vector2d& goal) {
  while (position() != goal) {
    const CriticalRay* const crossed = Move(goal, options_.clearance / 2.0);
    if (crossed == nullptr) continue;
    if (const auto event = Update(*crossed)) return event;
  }
  return std::nullopt;
}

double PointRobot::ClearanceAt(std::size_t vertex) const {
  return std::min(options_.clearance, polygon_.RoomAround(vertex) / 4.0);
}

const CriticalRay* PointRobot::Move(const Vector2d& goal, double beyond) {
  const Vector2d from = position();
  const double length = (goal - from).norm();
  // What is crossed up to `beyond` after the goal counts, too, so that a stop after an event is in front of
  // it.
  const double reach = 1.0 + beyond / length;
  const Vector2d end = from + reach * (goal - from);
  double first = std::numeric_limits<double>::infinity();
  double second = first;
  const CriticalRay* crossed = nullptr;
  for (const CriticalRay& ray : rays_) {
    const auto share = ShareAtCrossing(ray, from, end);
    if (!share) continue;
    const double at = *share * reach;
    if (at < first) {
      second = std::exchange(first, at);
      crossed = &ray;
    } else {
      second = std::min(second, at);
    }
  }
  if (first > 1.0) crossed = nullptr;
  const double stop = crossed == nullptr ? 1.0 : std::min(first + beyond / length, (first + second) / 2.0);
  if (crossed != nullptr) smallest_step_ = std::min(smallest_step_, (stop - first) * length);
  path_.push_back(stop == 1.0 ? goal : from + stop * (goal - from));
  length_ += stop * length;
  return crossed;
}

std::optional<GapEvent> PointRobot::Update(const CriticalRay& ray) {
  const bool hides = ray.Depth(position()) > 0.0;
  switch (ray.kind) {
    case CriticalRay::Kind::kSlide:
      gaps_[SlotOf(hides ? ray.far : ray.near)] = hides ? ray.near : ray.far;
      return std::nullopt;
    case CriticalRay::Kind::kInflection: {
      const std::size_t slot = hides ? SlotFor(ray.near) : SlotOf(ray.near);
      const auto at = gaps_.begin() + static_cast<std::ptrdiff_t>(slot);
      if (!hides) {
        gaps_.erase(at);
        return GapEvent{GapEvent::Kind::kDisappear, slot};
      }
      gaps_.insert(at, ray.near);
      return GapEvent{GapEvent::Kind::kAppear, slot};
    }
    case CriticalRay::Kind::kBitangent:
      break;
  }
  // In the order of directions, what `near` hides to its left is on its right when it comes out.
  const bool far_first = ray.hidden == GapSide::kLeft;
  if (!hides) {
    const std::size_t slot = SlotOf(ray.near);
    gaps_.insert(gaps_.begin() + static_cast<std::ptrdiff_t>(far_first ? slot : slot + 1), ray.far);
    return GapEvent{GapEvent::Kind::kSplit, slot};
  }
  const std::size_t slot = SlotOf(far_first ? ray.far : ray.near);
  const std::size_t next = slot + 1 == gaps_.size() ? 0 : slot + 1;
  if (gaps_[next] != (far_first ? ray.near : ray.far)) {
    throw std::runtime_error("gaps that are not neighbors merge: the polygon is not in general position");
  }
  gaps_[slot] = ray.near;
  gaps_.erase(gaps_.begin() + static_cast<std::ptrdiff_t>(next));
  return GapEvent{GapEvent::Kind::kMerge, slot};
}

std::size_t PointRobot::SlotOf(std::size_t vertex) const {
  const auto at = std::ranges::find(gaps_, vertex);
  if (at == gaps_.end()) {
    throw std::runtime_error("a gap changes that is not in sight: the polygon is not in general position");
  }
  return static_cast<std::size_t>(at - gaps_.begin());
}

std::size_t PointRobot::SlotFor(std::size_t vertex) const {
  const double direction = DirectionTo(position(), polygon_[vertex]);
  const auto turn = [&](std::size_t gap) {
    return LeftTurn(DirectionTo(position(), polygon_[gap]), direction);
  };
  if (gaps_.empty()) return 0;
  return static_cast<std::size_t>(std::ranges::min_element(gaps_, {}, turn) - gaps_.begin()) + 1;
}

}  // namespace thalweg::explorer
