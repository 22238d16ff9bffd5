#pragma once

#include <deque>

#include "common/base/result.h"
#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg {

/// The recent poses of the body, asked for the pose at the moment of a measurement.
class PoseHistory {
 public:
  struct Options {
    Duration length = FromSeconds(5.0);    ///< Older poses are forgotten.
    Duration max_gap = FromSeconds(0.25);  ///< No interpolation across a longer hole.
  };
  PoseHistory() : PoseHistory(Options{}) {}
  explicit PoseHistory(const Options& options) : options_(options) {}

  /// Takes the next pose. False, and ignored, when `stamp` is not later than the last one.
  bool Add(Time stamp, const RigidTransform& T_WB);

  /// The pose at `stamp`: linear in position, shortest arc in rotation, between the two poses around it.
  /// Error when the stamp is before the first, after the last, or within too long a gap.
  Result<RigidTransform> At(Time stamp) const;

  /// Whether a pose later than or at `stamp` has come, so that At() can no longer change its mind.
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
