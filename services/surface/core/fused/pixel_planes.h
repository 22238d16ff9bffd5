#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "common/geometry/depth_error.h"
#include "common/geometry/pinhole_camera.h"
#include "common/geometry/point_cloud.h"

namespace thalweg::surface {

/// The plane that a pixel sees, in the camera frame C.
struct PixelPlane {
  /// Unit normal, facing the camera. The distance of a point x from the plane is offset + normal^T x, > 0 on
  /// the camera's side.
  Eigen::Vector3f normal_C = Eigen::Vector3f::Zero();
  float offset = 0.0F;  ///< [m]
  float cosine = 0.0F;  ///< Cosine of the angle between the normal and the ray to the camera.
  float sigma = 0.0F;   ///< [m] Standard deviation of the plane's distance, from the sensor's stated error.
  /// [m] Depth of the pixel's point; NaN = no plane is known here.
  float depth = std::numeric_limits<float>::quiet_NaN();

  bool known() const { return depth == depth; }
  float DistanceTo(const Eigen::Vector3f& p_C) const { return offset + normal_C.dot(p_C); }
};

/// The plane that each pixel of an organized cloud sees, and where neighbors see one surface.
///
/// The inverse depth of a plane is linear in the pixel's coordinates, 1/z = a (u - u0) + b (v - v0) + c, and
/// the plane is m^T x = 1 with
///   m = (a fx, b fy, c + a (cx - u0) + b (cy - v0)).
/// a, b and c are fitted by least squares to a window of pixels. At the edge of a surface a centered window
/// would mix two, so that of nine windows (around the pixel, and with the pixel on each side and in each
/// corner) the first whose residuals are within the sensor's error is taken, else that with the least
/// [Kuwahara et al., Processing of RI-angiocardiographic images, 1976; Katkovnik, Egiazarian, Astola, 2006].
/// The window's size follows from the stated error: the smallest for which the normal is off by less than
/// kNormalError, from 3 to the model's window_px. The plane passes through the pixel's own point if the
/// sensor is exact or no window fits; else c replaces the measured value.
class PixelPlanes {
 public:
  static constexpr double kNormalError = 0.1;  ///< [rad]

  /// Directions of the four pixels that surround a point, given by its nearest pixel: bit 0 = the other
  /// column is to the right, bit 1 = the other row is below.
  static constexpr int kQuadrants = 4;

  /// @param cloud      Has the camera's size. Points that are not finite are not measured.
  /// @param tolerance  [m] Points this near to a plane are on it.
  void Compute(const PointCloud& cloud, const PinholeCamera& camera, const DepthErrorModel& error,
               double tolerance);

  const PixelPlane& at(std::size_t pixel) const { return planes_[pixel]; }
  /// Whether the four pixels of a quadrant see one surface.
  bool IsOneSurface(std::size_t pixel, int quadrant) const {
    return (one_surface_[pixel] >> quadrant & 1) != 0;
  }
  /// [m] The least depth in a quadrant; 0 if one of the four was not measured.
  float LeastDepth(std::size_t pixel, int quadrant) const {
    return least_depths_[pixel * kQuadrants + static_cast<std::size_t>(quadrant)];
  }

 private:
  /// Sums over measured pixels: count, coordinates u, v [px] and inverse depths w [1/m].
  struct Sums {
    double n = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0, w = 0, uw = 0, vw = 0, ww = 0;
  };
  struct Fit {
    double a, b, c;
    double residual;  ///< [1/m] Root mean square.
    double variance;  ///< The variance of c, in units of sigma^2.
  };
  void Sum(const PointCloud& cloud);
  Sums Within(int left, int top, int right, int bottom) const;
  bool FitTo(int u, int v, int left, int top, int right, int bottom, Fit& fit) const;
  void FitPlane(int u, int v, const Eigen::Vector3f& p_C, const PinholeCamera& camera,
                const DepthErrorModel& error, double tolerance, PixelPlane& plane) const;
  void CompareNeighbors(const PointCloud& cloud, const DepthErrorModel& error, double tolerance);

  int width_ = 0, height_ = 0;
  std::vector<Sums> sums_;  ///< Integral image, with one more row and column.
  std::vector<PixelPlane> planes_;
  std::vector<std::uint8_t> one_surface_;
  std::vector<float> least_depths_;
};

}  // namespace thalweg::surface
