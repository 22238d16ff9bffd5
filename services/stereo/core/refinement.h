#pragma once

#include "services/stereo/core/image.h"

namespace thalweg::stereo {

struct RefinementOptions {
  /// [px] Matches this close to a jump or a gap are dropped, since windows straddle two surfaces there.
  int margin = 1;
  double jump = 1.5;       ///< [px] Larger differences between neighbors separate two surfaces.
  int least_region = 300;  ///< [px] Surfaces of fewer remaining pixels are dropped; 0: none.
  /// [px] Radius of the windows within which a surface is assumed to be smooth.
  int radius = 3;
  double same_surface = 0.75;  ///< [px] Largest difference from the window's center on the same surface.
  /// [gray values / px] Windows with a smaller mean gradient are hardly adjusted.
  double least_gradient = 1.0;
  int max_difference = 15;  ///< [gray values] Pixels that differ by more do not show the same point.
};

/// Throws std::invalid_argument naming the bad option.
void CheckOptions(const RefinementOptions& options);

/// Refines disparities for triangulation. A matcher's subpixel parabola through three costs is noisy and
/// biased toward whole pixels, which makes the walls of a map thick; and in areas that the right camera does
/// not see, islands of pixels match something far behind, whose rays cut holes into the map's walls.
///
/// Refine drops matches near edges, and small islands. It then takes one least-squares step on the images
/// themselves [Lucas, Kanade, IJCAI 1981], over windows and invariant to a difference in brightness, and
/// before and after that averages over neighbors on the same surface.
/// @param left, right  Grayscale.
/// @param threads      0 = one per core.
void Refine(const ByteImage& left, const ByteImage& right, const RefinementOptions& options,
            std::size_t threads, DisparityMap& disparity);

}  // namespace thalweg::stereo
