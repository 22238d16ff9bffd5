#pragma once

#include <cmath>
#include <limits>

namespace thalweg {

/// Depth error of a stereo sensor. Its inverse depth, disparity / (f b), has the same error sigma at every
/// range, so that a depth z has the error sigma z^2.
struct DepthErrorModel {
  double sigma = 0.0;  ///< [1/m] Standard deviation of inverse depth; 0 = exact.
  /// [px] Odd. Edge of the window over which a mapper may average where the pixels show one plane. 1 = no
  /// averaging, as for errors that neighboring pixels share.
  int window_px = 11;

  /// [m] Depth up to which the averaged error is at most a quarter of a voxel, so that a point measured at a
  /// voxel's center lies in that voxel with a probability of 95 %.
  double SureRange(double voxel_size) const {
    if (sigma <= 0.0) return std::numeric_limits<double>::infinity();
    return std::sqrt(voxel_size * window_px / (4.0 * sigma));
  }
};

}  // namespace thalweg
