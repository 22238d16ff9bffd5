#pragma once

#include "services/stereo/core/image.h"

namespace thalweg::stereo {

struct RefinementOptions {
  int margin = 1;  ///< [px] Matches so near a jump or a gap are dropped: windows straddle two surfaces there.
  double jump = 1.5;            ///< [px] Between neighbours of two surfaces.
  int least_region = 300;       ///< [px] What is left of a surface is dropped when it is smaller; 0: none.
  int radius = 3;               ///< [px] Of the windows over which a surface is taken as smooth.
  double same_surface = 0.75;   ///< [px] From the middle of such a window, at most.
  double least_gradient = 1.0;  ///< [grey values / px] A window of less, in the mean, says nothing.
  int max_difference = 15;      ///< [grey values] Pixels that differ by more are not the same thing.
};

/// Throws std::invalid_argument naming the bad option.
void CheckOptions(const RefinementOptions& options);

/// Makes disparities fit for triangulation: where a matcher's parabola through three costs is drawn to whole
/// pixels and noisy, walls of a map come out thick; and of what the right camera does not see islands match
/// something far behind, whose rays open a map's walls. Drops what lies at edges, and islands; then one step
/// of least squares on the images themselves [Lucas, Kanade, IJCAI 1981], over windows, which no difference
/// in brightness between the two images moves; before and after it the mean over the neighbours on the same
/// surface.
/// @param left, right  Grey.
/// @param threads      0 = one a core.
void Refine(const ByteImage& left, const ByteImage& right, const RefinementOptions& options,
            std::size_t threads, DisparityMap& disparity);

}  // namespace thalweg::stereo
