#include "services/link/core/pose_thinning.h"

#include <algorithm>
#include <utility>

namespace thalweg::link {

bool RateLimit::Passes(Time stamp) {
  // A stamp before the last one: the clock was restarted.
  if (last_ && stamp >= *last_ && stamp - *last_ < period_) return false;
  last_ = stamp;
  return true;
}

bool PoseThinning::CanSkipUntil(const Pose& pose) const {
  return std::ranges::all_of(skipped_, [&](const Pose& skipped) {
    const double share = Seconds(skipped.stamp - passed_->stamp) / Seconds(pose.stamp - passed_->stamp);
    const RigidTransform T = Interpolate(passed_->T, pose.T, share);
    return (T.translation() - skipped.T.translation()).norm() <= options_.position &&
           AngleBetween(T, skipped.T) <= options_.angle;
  });
}

std::vector<Buffer> PoseThinning::Add(Time stamp, const RigidTransform& T, Buffer message) {
  std::vector<Buffer> passing;
  const Pose pose{stamp, T};
  const Time newest = !skipped_.empty() ? skipped_.back().stamp : passed_ ? passed_->stamp : stamp;
  const bool follows = passed_ && stamp > newest;
  if (follows && !CanSkipUntil(pose)) {
    passing.push_back(std::exchange(last_skipped_, {}));
    passed_ = skipped_.back();
    skipped_.clear();
  }
  if (follows && stamp - passed_->stamp < options_.period) {
    skipped_.push_back(pose);
    last_skipped_ = std::move(message);
    return passing;
  }
  passing.push_back(std::move(message));
  passed_ = pose;
  skipped_.clear();
  return passing;
}

}  // namespace thalweg::link
