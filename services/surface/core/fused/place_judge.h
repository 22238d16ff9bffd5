#pragma once

#include <cstddef>
#include <optional>

#include "common/geometry/rigid_transform.h"
#include "common/voxel/map_agreement.h"

namespace thalweg::surface {

/// Judges by several views whether clouds are of the place that a volume remembers. A single view may
/// mislead: past an edge, or through what was seen from one side only, more rays may contradict than agree.
/// Over a few views of the same place they do not. Threading: one thread.
class PlaceJudge {
 public:
  enum class Verdict { kUndecided, kSame, kOther };

  /// Takes note of how a cloud agrees. One that tells nothing, or from nearly the same view as the last that
  /// counted, only brings the decision nearer.
  Verdict Judge(const MapAgreement& agreement, const RigidTransform& T_WC) {
    const bool other_view = !last_ || (T_WC.translation() - last_->translation()).norm() > kMoved ||
                            AngleBetween(T_WC, *last_) > kTurned;
    if (agreement.IsTelling() && other_view) {
      sum_.agreeing += agreement.agreeing;
      sum_.contradicting += agreement.contradicting;
      last_ = T_WC;
      ++views_;
    }
    if (++clouds_ < kMostClouds && views_ < kViews) return Verdict::kUndecided;
    return sum_.IsOfAnotherPlace() ? Verdict::kOther : Verdict::kSame;
  }
  /// The rays of all views that counted.
  const MapAgreement& sum() const { return sum_; }

 private:
  static constexpr std::size_t kViews = 5;
  static constexpr std::size_t kMostClouds = 50;
  static constexpr double kMoved = 0.2;   // [m]
  static constexpr double kTurned = 0.3;  // [rad]

  MapAgreement sum_;
  std::optional<RigidTransform> last_;
  std::size_t views_ = 0;
  std::size_t clouds_ = 0;
};

}  // namespace thalweg::surface
