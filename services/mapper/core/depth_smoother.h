#pragma once

#include <span>
#include <vector>

#include "common/geometry/depth_error.h"
#include "common/geometry/point_cloud.h"

namespace thalweg::mapper {

/// Smooths the depths of a stereo sensor and estimates the standard deviation of each.
///
/// The inverse depth of a stereo sensor, disparity / (f b), has the same error sigma everywhere, and the
/// inverse depth of a plane is linear in pixel coordinates. Each pixel therefore gets the value of the plane
/// fitted by least squares to its neighborhood. Of several windows (centered on the pixel, or with the pixel
/// on an edge or in a corner), the largest is used whose pixels may lie on one plane given the noise. Three
/// tests decide this: chi^2 of the residuals must not lie far above its expected value; nor may chi^2 of the
/// mean residuals of the window's ninths, which reveals a step that the total hides; and the pixel's own
/// residual must be small. The standard deviation follows from the normal equations [local polynomials with a
/// data-driven window: Katkovnik, Egiazarian, Astola: Local Approximation Techniques in Signal and Image
/// Processing, SPIE, 2006]. Where no window passes, the measurement is kept as it is.
class DepthSmoother {
 public:
  /// Throws std::invalid_argument naming the bad value.
  /// @param error  Its sigma must be > 0.
  explicit DepthSmoother(const DepthErrorModel& error);

  /// @param cloud  Must be organized to be smoothed; the points of other clouds are kept as they are.
  void Smooth(const PointCloud& cloud);
  /// For each point of the last cloud, 1 / z and its standard deviation [1/m]; NaN where nothing was
  /// measured.
  std::span<const float> inverse_depths() const { return inverse_depths_; }
  std::span<const float> sigmas() const { return sigmas_; }

 private:
  /// Moments of measured pixels: count n, and sums over coordinates u, v [px] and inverse depths w [1/m].
  struct Sums {
    double n = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0, w = 0, uw = 0, vw = 0, ww = 0;
    void Add(const Sums& other, double sign);
    /// Returns the same moments about another origin.
    Sums About(double u0, double v0) const;
  };
  /// The pixels from (u + left, v + top) to (u + right, v + bottom), inclusive.
  struct Window {
    int left, top, right, bottom;
    /// Variance of the plane's value at (u, v), in units of sigma^2, if all pixels are measured.
    double variance;
  };

  void Sum(int width, int height, std::span<const float> measured);
  bool Fit(const Window& window, int u, int v, float measured, std::size_t pixel);

  DepthErrorModel error_;
  std::vector<Window> windows_;  ///< In order of increasing variance.
  std::vector<float> measured_;
  /// Integral image: sums over all pixels above and to the left; one extra row and column.
  std::vector<Sums> sums_;
  int width_ = 0, height_ = 0;
  std::vector<float> inverse_depths_;
  std::vector<float> sigmas_;
};

}  // namespace thalweg::mapper
