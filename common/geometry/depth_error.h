#pragma once

#include <cmath>
#include <limits>

namespace thalweg {

/// How wrong the depths of a stereo sensor are. Its inverse depth, disparity / (f b), errs by the same sigma
/// at every range; depth z so errs by sigma z^2.
struct DepthErrorModel {
  double sigma = 0.0;  ///< [1/m] of inverse depth; 0 = exact.
  /// [px] Odd. Over how many pixels a mapper may average where they show one plane; 1 = not at all, as for
  /// errors that neighbouring pixels share.
  int window_px = 11;

  /// [m] Up to which depth an averaged error is at most a quarter of a voxel, so that a point in its middle
  /// lies in it with a probability of 95 %.
  double SureRange(double voxel_size) const {
    if (sigma <= 0.0) return std::numeric_limits<double>::infinity();
    return std::sqrt(voxel_size * window_px / (4.0 * sigma));
  }
};

}  // namespace thalweg
