#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/point_cloud.h"
#include "services/link/core/packing.h"

namespace thalweg::link {

/// Largest number of points of a cloud that crosses.
inline constexpr std::size_t kMostPoints = 1U << 22U;

/// The direction of each pixel of an organized sensor, as the point where its ray meets the plane z = 1. That
/// of a pinhole camera takes four numbers, any other a pair for each pixel.
class RayTable {
 public:
  struct Pinhole {
    double x0 = 0.0;  ///< x / z of column 0.
    double dx = 0.0;  ///< From column to column.
    double y0 = 0.0;  ///< y / z of row 0.
    double dy = 0.0;
  };
  RayTable(int width_px, int height_px, const Pinhole& pinhole);
  /// @param xy  x / z and y / z for each pixel, row-major; NaN = unknown.
  RayTable(int width_px, int height_px, std::vector<Eigen::Vector2f> xy);

  /// A table that fits the measured points of an organized cloud: a pinhole camera if there is one, else the
  /// points' own directions, with those of `before` for pixels that are not measured. Nothing if a measured
  /// point lies behind the sensor.
  static std::optional<RayTable> Of(const PointCloud& cloud, double tolerance, const RayTable* before);

  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }
  /// x / z and y / z of a pixel.
  Eigen::Vector2f At(std::size_t pixel) const;
  /// Whether the cloud has the table's size, and each measured point lies within `tolerance` [m] of its
  /// pixel's ray, at its own depth.
  bool Fits(const PointCloud& cloud, double tolerance) const;
  std::uint64_t hash() const { return hash_; }  ///< Never 0.

  Buffer Encode() const;
  static Result<RayTable> Decode(Bytes bytes);

 private:
  int width_px_;
  int height_px_;
  std::optional<Pinhole> pinhole_;
  std::vector<Eigen::Vector2f> xy_;  ///< Empty for a pinhole camera.
  std::uint64_t hash_ = 0;
};

}  // namespace thalweg::link
