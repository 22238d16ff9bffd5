#pragma once

#include <span>

#include "services/stereo/core/image.h"
#include "services/stereo/core/kernels.h"

namespace thalweg::stereo {

/// The pixels that count as a pixel's neighbors: those that share an edge with it, or also those that share
/// only a corner.
enum class Connectivity { kFour, kEight };

/// Removes regions of fewer than `min_pixels` pixels. A region is a set of connected pixels whose neighbors
/// differ by at most `max_step` [px]. O(pixels).
void RemoveSmallRegions(DisparityMap& disparity, int min_pixels, float max_step,
                        Connectivity connectivity = Connectivity::kFour);

/// Vertex of the parabola through the costs at -1, 0 and 1, of which the middle one is the smallest: a value
/// in [-0.5, 0.5]; 0 where all three are equal.
inline float ParabolaVertex(float before, float here, float after) {
  const float curvature = before - 2.0F * here + after;
  return curvature > 0.0F ? 0.5F * (before - after) / curvature : 0.0F;
}

/// Converts a row of choices into disparities, checked against the choices of the right pixels.
struct RowChecks {
  /// Smallest accepted (C2 - C1) / C1, Eq. (3.29). Where there is no C2, there is no match.
  double uniqueness;
  int left_right;  ///< [px] Largest accepted difference between left and right; < 0: no check.
  bool subpixel;
};
void CheckRow(const RowChecks& checks, std::span<const Choice> choices, const RightBest& right, float* out);

}  // namespace thalweg::stereo
