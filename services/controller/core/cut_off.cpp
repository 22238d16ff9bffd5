#include "services/controller/core/cut_off.h"

#include <algorithm>

#include "common/base/require.h"

namespace thalweg::controller {
namespace {

constexpr double kShortest = 0.05;  // [m] Shorter paths back are not taken.

}  // namespace

CutOff::CutOff(const Options& options) : options_(options) {
  Require(options.after > 0.0, "cut_off.after", options.after, "> 0 s");
  Require(options.step > 0.0, "cut_off.step", options.step, "> 0 m");
}

void CutOff::Heard(Time now) {
  since_ = now;
  paths_back_ = 0;
  heard_at_ = flown_.end();
}

std::optional<std::vector<RigidTransform>> CutOff::PathBack(Time now) {
  since_ = std::min(since_, now);  // the clock may have been reset
  const bool goes_back = options_.action == OnCutOff::kRetreat || options_.action == OnCutOff::kHome;
  if (!goes_back || Seconds(now - since_) < options_.after) return std::nullopt;
  const double here = flown_.end();
  double goal = flown_.begin();
  if (options_.action == OnCutOff::kRetreat) {
    goal = std::max(goal, paths_back_ == 0 ? std::min(heard_at_, here) : here - options_.step);
  }
  if (paths_back_ == 0 && here - goal < kShortest) {  // the robot is there already, and waits
    ++paths_back_;
    goal_ = goal;
    since_ = now;
  }
  if (here - goal < kShortest) return std::nullopt;
  ++paths_back_;
  goal_ = goal;
  return flown_.BackTo(goal);
}

void CutOff::EndPathBack(double left, Time now) {
  flown_.Shorten(goal_ + left);
  since_ = now;
}

std::optional<BackPlace> CutOff::place() const {
  if (paths_back_ == 0) return std::nullopt;
  if (goal_ <= flown_.begin())
    return flown_.begin() > 0.0 ? BackPlace::kFarthestRemembered : BackPlace::kBeginning;
  const bool last_heard = paths_back_ == 1 && goal_ <= heard_at_ && heard_at_ - goal_ < kShortest;
  return last_heard ? BackPlace::kLastHeard : BackPlace::kFartherBack;
}

}  // namespace thalweg::controller
