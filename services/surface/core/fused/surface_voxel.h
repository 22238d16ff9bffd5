#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/geometry/point_cloud.h"
#include "services/surface/core/fused/view_quality.h"

namespace thalweg::surface {

/// What a view says about a point, such as the center of a voxel.
struct Observation {
  float distance = 0.0F;  ///< [m] Signed, to the surface seen; > 0 before it. At most the truncation.
  float weight = 0.0F;    ///< (0, 1]
  float margin = 0.0F;    ///< [m] Farther behind the surface than this, nothing was seen.
};

/// One voxel of a truncated signed distance volume [Curless, Levoy, A volumetric method for building complex
/// models from range images, SIGGRAPH 1996, Sec. 3]:
///   D <- (W D + w d) / (W + w),  W <- min(W + w, kMostWeight)
/// Departure: what is farther behind a surface than the view's margin was not seen, and is only assumed to be
/// solid. Where a view has been through a point, assumptions no longer count; and an assumption that a view
/// contradicts loses the view's weight until it gives way. So the two sides of a thin board do not erase each
/// other, and stray surface in free space vanishes.
struct SurfaceVoxel {
  /// Old measurements fade: of a surface that moves, most is forgotten after this many good views.
  static constexpr float kMostWeight = 64.0F;
  static constexpr float kMostAssumed = 2.0F;  ///< Largest weight of what is only assumed.
  static constexpr float kFreeWeight = 1e-3F;  ///< Weight of a distance only known to be > 0.

  /// [m] Smaller ones are rounding: a robot that stands still changes nothing.
  static constexpr float kLeastCorrection = 1e-6F;

  float distance = 0.0F;  ///< [m] Only if known().
  float weight = 0.0F;
  PackedQuality best;   ///< The best views of the surface in this voxel.
  PackedLength finest;  ///< [m] The least spacing of pixels at which a surface was seen in or beside it.
  Rgb color;            ///< Only if colored.
  bool seen_through : 1 = false;  ///< Whether a view has seen this point to be before a surface.
  bool colored : 1 = false;

  bool known() const { return weight > 0.0F; }

  /// Returns whether the voxel has changed.
  bool Fuse(const Observation& seen) {
    const bool assumed = seen.distance < -seen.margin;
    if (assumed && seen_through) return false;
    if (seen.distance > 0.0F) {
      const bool contradicted = known() && distance < -seen.margin;
      if (contradicted && !seen_through) weight = std::min(weight, kMostAssumed);
      seen_through = true;
      if (contradicted) {
        weight -= seen.weight;
        if (weight > 0.0F) return true;
        weight = 0.0F;
      }
    }
    const bool was_known = known();
    const float sum = weight + seen.weight;
    const float correction = seen.weight / sum * (seen.distance - distance);
    weight = std::min(sum, assumed ? std::max(weight, kMostAssumed) : kMostWeight);
    if (was_known && std::abs(correction) < kLeastCorrection) return false;
    distance = was_known ? distance + correction : seen.distance;
    return true;
  }

  /// A view has been through this point to a surface farther behind it than the truncation. This says that
  /// the point is in free space, not how far from a surface that other views saw beside it.
  /// @param distance_if_unknown  [m] > 0, of a point of which nothing else is known.
  bool FuseFree(float distance_if_unknown, float free_weight) {
    const bool was_seen_through = seen_through;
    seen_through = true;
    if (known() && distance >= 0.0F) return !was_seen_through;
    if (known()) {
      if (!was_seen_through) weight = std::min(weight, kMostAssumed);
      weight -= free_weight;
      if (weight > 0.0F) return true;
    }
    distance = distance_if_unknown;
    weight = kFreeWeight;
    return true;
  }

  /// Mixes a color in, with the share of the last observation in the weight.
  void Paint(const Rgb& seen, float seen_weight) {
    const float share = colored ? std::min(1.0F, seen_weight / weight) : 1.0F;
    const auto mixed = [share](std::uint8_t old_value, std::uint8_t new_value) {
      const float value = static_cast<float>(old_value) +
                          share * (static_cast<float>(new_value) - static_cast<float>(old_value));
      return static_cast<std::uint8_t>(std::lround(value));
    };
    color = {mixed(color.r, seen.r), mixed(color.g, seen.g), mixed(color.b, seen.b)};
    colored = true;
  }
};

}  // namespace thalweg::surface
