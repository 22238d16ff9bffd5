#include "services/controller/core/cut_off.h"

#include <algorithm>
#include <stdexcept>

namespace thalweg::controller {
namespace {

constexpr double kNoWay = 0.05;  // [m] Ways back that are shorter are not taken.

}  // namespace

CutOff::CutOff(const Options& options) : options_(options) {
  if (!(options.after > 0.0)) throw std::invalid_argument("cut_off.after = " + std::to_string(options.after));
  if (!(options.step > 0.0)) throw std::invalid_argument("cut_off.step = " + std::to_string(options.step));
}

void CutOff::Heard(Time now) {
  since_ = now;
  ways_back_ = 0;
  heard_at_ = flown_.end();
}

std::optional<std::vector<RigidTransform>> CutOff::WayBack(Time now) {
  since_ = std::min(since_, now);  // the clock may have been reset
  if (options_.action == OnCutOff::kStand || Seconds(now - since_) < options_.after) return std::nullopt;
  const double here = flown_.end();
  double goal = flown_.begin();
  if (options_.action == OnCutOff::kRetreat) {
    goal = std::max(goal, ways_back_ == 0 ? std::min(heard_at_, here) : here - options_.step);
  }
  if (ways_back_ == 0 && here - goal < kNoWay) {  // the robot is there already, and waits
    ++ways_back_;
    goal_ = goal;
    since_ = now;
  }
  if (here - goal < kNoWay) return std::nullopt;
  ++ways_back_;
  goal_ = goal;
  return flown_.BackTo(goal);
}

void CutOff::EndWayBack(double left, Time now) {
  flown_.Shorten(goal_ + left);
  since_ = now;
}

std::string CutOff::PlaceText() const {
  if (goal_ <= flown_.begin()) return flown_.begin() > 0.0 ? "as far back as it remembers" : "where it began";
  return ways_back_ == 1 && goal_ <= heard_at_ && heard_at_ - goal_ < kNoWay
             ? "where the explorer was last heard"
             : "farther back on the path that it came";
}

std::string CutOff::GoingText() const {
  return "path silent: going back to " + PlaceText();
}

std::string CutOff::WaitingText() const {
  return ways_back_ == 0 ? "" : "path silent: went back, waiting " + PlaceText();
}

}  // namespace thalweg::controller
