#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "common/geometry/inspection_criterion.h"

namespace thalweg::surface {

/// How well a view sees a piece of surface.
struct ViewQuality {
  float distance = std::numeric_limits<float>::infinity();  ///< [m] From the camera.
  float cosine = 0.0F;                                      ///< Cosine of the angle to the surface's normal.
  /// [m] On the surface, between the points of neighboring pixels, in the direction in which that is larger.
  float sampling = std::numeric_limits<float>::infinity();
};

/// What counts as inspected, and as sampled finely.
struct InspectionLimits {
  float distance = static_cast<float>(InspectionCriterion{}.distance);  ///< [m]
  float cosine = static_cast<float>(
      InspectionCriterion{}.least_cosine());  ///< Cosine of the largest angle to the normal.
  float sampling = 5e-3F;                     ///< [m]

  /// Whether a view is both near and square enough.
  bool Inspects(const ViewQuality& view) const { return view.distance <= distance && view.cosine >= cosine; }
  bool SamplesFinely(const ViewQuality& view) const { return view.sampling <= sampling; }
};

/// A length up to 6.5 m, rounded to 0.1 mm; the largest one at first.
class PackedLength {
 public:
  static constexpr float kStep = 1e-4F;  ///< [m]
  float value() const { return static_cast<float>(steps_) * kStep; }
  /// Returns whether the length becomes less.
  bool Lower(float length) {
    const auto steps = static_cast<std::uint16_t>(std::round(std::clamp(length / kStep, 0.0F, 65535.0F)));
    if (steps >= steps_) return false;
    steps_ = steps;
    return true;
  }

 private:
  std::uint16_t steps_ = 65535;
};

/// The best of several views in each respect, rounded: distances to 1 mm, samplings to 0.1 mm, cosines to
/// 1/254. Distances beyond 65 m are this.
class PackedQuality {
 public:
  bool seen() const { return cosine_ > 0; }
  float distance() const { return static_cast<float>(distance_mm_) * 1e-3F; }
  float cosine() const { return static_cast<float>(cosine_) / kCosineSteps; }
  float sampling() const { return sampling_.value(); }
  bool inspected() const { return inspected_ != 0; }  ///< By one view both near and square enough.

  /// Returns whether a view improves on the best ones.
  bool Improve(const ViewQuality& view, bool inspects) {
    const auto mm = static_cast<std::uint16_t>(std::round(std::clamp(view.distance * 1e3F, 0.0F, 65535.0F)));
    const auto cosine =
        static_cast<std::uint8_t>(std::round(std::clamp(view.cosine * kCosineSteps, 1.0F, kCosineSteps)));
    bool better = sampling_.Lower(view.sampling);
    better = better || mm < distance_mm_ || cosine > cosine_ || (inspects && !inspected());
    distance_mm_ = std::min(mm, distance_mm_);
    cosine_ = std::max(cosine, cosine_);
    if (inspects) inspected_ = 1;
    return better;
  }

 private:
  static constexpr float kCosineSteps = 254.0F;

  std::uint16_t distance_mm_ = 65535;
  PackedLength sampling_;
  std::uint8_t cosine_ = 0;
  std::uint8_t inspected_ = 0;  ///< Not bool, since it is read from files.
};

}  // namespace thalweg::surface
