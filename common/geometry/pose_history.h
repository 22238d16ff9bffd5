#pragma once

#include <deque>

#include "common/base/result.h"
#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg {

/// The recent poses of the body, from which the pose at the time of a measurement is interpolated.
class PoseHistory {
 public:
  struct Options {
    Duration length = FromSeconds(5.0);    ///< Older poses are discarded.
    Duration max_gap = FromSeconds(0.25);  ///< Longer gaps between poses are not interpolated.
  };
  PoseHistory() : PoseHistory(Options{}) {}
  explicit PoseHistory(const Options& options) : options_(options) {}

  /// Adds the next pose. Returns false and ignores it if `stamp` is not later than the last one.
  bool Add(Time stamp, const RigidTransform& T_WB);

  /// The pose at `stamp`, interpolated between the poses before and after it: linearly in position, along the
  /// shortest arc in rotation. Error if the stamp is before the first pose, after the last, or within too
  /// long a gap.
  Result<RigidTransform> At(Time stamp) const;

  /// Whether a pose at or after `stamp` has been added, so that later poses cannot change the result of At().
  bool Reaches(Time stamp) const { return !poses_.empty() && poses_.back().stamp >= stamp; }
  void Clear() { poses_.clear(); }

 private:
  struct Entry {
    Time stamp;
    RigidTransform T_WB;
  };
  Options options_;
  std::deque<Entry> poses_;
};

}  // namespace thalweg
