#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "common/geometry/rigid_transform.h"
#include "common/voxel/map_agreement.h"

namespace thalweg::surface {

/// Judges by several views whether clouds are of the place that a volume remembers. A single view may
/// mislead: past an edge, or through what was seen from one side only, more rays may contradict than agree.
/// Over a few views of the same place they do not. Threading: one thread.
class PlaceJudge {
 public:
  enum class Verdict { kUndecided, kSame, kOther };

  /// Takes note of how a cloud agrees. One that tells nothing, or from nearly the same view as one that
  /// counted, only brings the decision nearer.
  Verdict Judge(const MapAgreement& agreement, const RigidTransform& T_WC) {
    if (agreement.IsTelling() && std::ranges::none_of(views_, [&](const RigidTransform& view) {
          return (T_WC.translation() - view.translation()).norm() <= kMoved &&
                 AngleBetween(T_WC, view) <= kTurned;
        })) {
      sum_.agreeing += agreement.agreeing;
      sum_.contradicting += agreement.contradicting;
      views_.push_back(T_WC);
    }
    if (++clouds_ < kMostClouds && views_.size() < kViews) return Verdict::kUndecided;
    if (!sum_.IsOfAnotherPlace()) return Verdict::kSame;
    return views_.size() < kLeastViews ? Verdict::kUndecided : Verdict::kOther;
  }
  /// The rays of all views that counted.
  const MapAgreement& sum() const { return sum_; }

 private:
  static constexpr std::size_t kViews = 5;
  static constexpr std::size_t kLeastViews = 3;  ///< To refuse the place by.
  static constexpr std::size_t kMostClouds = 50;
  static constexpr double kMoved = 0.2;   // [m]
  static constexpr double kTurned = 0.3;  // [rad]

  MapAgreement sum_;
  std::vector<RigidTransform> views_;  ///< T_WC of those that counted.
  std::size_t clouds_ = 0;
};

}  // namespace thalweg::surface
