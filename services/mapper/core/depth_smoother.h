#pragma once

#include <span>
#include <vector>

#include "common/geometry/depth_error.h"
#include "common/geometry/point_cloud.h"

namespace thalweg::mapper {

/// Makes better depths of those of a stereo sensor, and says how good each is.
///
/// A stereo sensor's inverse depth, disparity / (f b), errs by the same sigma everywhere, and that of a plane
/// is linear in pixel coordinates. So each pixel gets the value of the plane that fits its neighbours best
/// in least squares, over the largest of a few windows (centred on it, or with it on an edge or in a
/// corner) that the noise permits to be one plane: chi^2 of the residuals, and that of their means over the
/// window's ninths, in which a step shows that the sum hides, are not far above their means, nor is the
/// pixel's own residual. Its standard deviation follows from
/// the normal equations [local polynomials with a data-driven window: Katkovnik, Egiazarian, Astola: Local
/// Approximation Techniques in Signal and Image Processing, SPIE, 2006]. Where no window fits the measurement
/// stands as it is.
class DepthSmoother {
 public:
  /// Throws std::invalid_argument naming what is bad. @param error  With sigma > 0.
  explicit DepthSmoother(const DepthErrorModel& error);

  /// @param cloud  An unorganised one is not smoothed.
  void Smooth(const PointCloud& cloud);
  /// Of each point of the last cloud: 1 / z and its sigma [1/m]; NaN where nothing was measured.
  std::span<const float> inverse_depths() const { return inverse_depths_; }
  std::span<const float> sigmas() const { return sigmas_; }

 private:
  /// Moments of measured pixels: of their number, coordinates u, v [px] and inverse depths w.
  struct Sums {
    double n = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0, w = 0, uw = 0, vw = 0, ww = 0;
    void Add(const Sums& other, double sign);
    /// The same moments about another origin.
    Sums About(double u0, double v0) const;
  };
  /// Pixels (u + left, v + top) to (u + right, v + bottom), inclusive.
  struct Window {
    int left, top, right, bottom;
    double variance;  ///< Of the plane's value at (u, v), in units of sigma^2, when all pixels are measured.
  };

  void Sum(int width, int height, std::span<const float> measured);
  bool Fit(const Window& window, int u, int v, float measured, std::size_t pixel);

  DepthErrorModel error_;
  std::vector<Window> windows_;  ///< From the one of the least error to that of the greatest.
  std::vector<float> measured_;
  std::vector<Sums> sums_;  ///< Over all pixels above and to the left; one more column and row.
  int width_ = 0, height_ = 0;
  std::vector<float> inverse_depths_;
  std::vector<float> sigmas_;
};

}  // namespace thalweg::mapper
