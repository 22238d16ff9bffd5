#include "common/geometry/pose_history.h"

#include <algorithm>
#include <string>

#include "common/base/duration_text.h"

namespace thalweg {

bool PoseHistory::Add(Time stamp, const RigidTransform& T_WB) {
  if (!poses_.empty() && stamp <= poses_.back().stamp) return false;
  poses_.push_back({stamp, T_WB});
  while (stamp - poses_.front().stamp > options_.length) poses_.pop_front();
  return true;
}

Result<RigidTransform> PoseHistory::At(Time stamp) const {
  if (poses_.empty()) return Error{"no pose yet"};
  if (stamp < poses_.front().stamp) {
    const Duration early = poses_.front().stamp - stamp;
    // The first message of a run may be early by less.
    const char* const question = early > std::chrono::seconds(1) ? ": do both come from one clock?" : "";
    return Error{"stamp is " + DurationText(Seconds(early)) + " before the oldest pose" + question};
  }
  if (stamp > poses_.back().stamp) {
    return Error{"stamp is " + DurationText(Seconds(stamp - poses_.back().stamp)) + " after the newest pose"};
  }
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), stamp,
                                      [](const Entry& entry, Time t) { return entry.stamp < t; });
  if (after->stamp == stamp) return after->T_WB;
  const auto before = std::prev(after);
  const Duration gap = after->stamp - before->stamp;
  if (gap > options_.max_gap) {
    return Error{"stamp falls into a gap of " + DurationText(Seconds(gap)) + " between poses"};
  }
  return Interpolate(before->T_WB, after->T_WB, Seconds(stamp - before->stamp) / Seconds(gap));
}

}  // namespace thalweg
