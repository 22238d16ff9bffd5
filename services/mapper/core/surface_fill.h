#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

#include "common/geometry/point_cloud.h"

namespace thalweg::mapper {

/// Finds neighboring pixels between which a surface continues, so that the map can close the gaps between the
/// points of a sparse or grazing view.
///
/// The inverse depth of a plane is linear in pixel coordinates. Two neighbors therefore belong to one plane
/// if the second difference of inverse depth, over them and the next pixel before or after them on the same
/// line, vanishes.
class SurfaceFill {
 public:
  struct Options {
    double min_gap = 0.07;     ///< [m] Nearer points leave no voxel between them.
    double max_gap = 0.4;      ///< [m]
    double tolerance = 0.004;  ///< Largest second difference, relative to the inverse depth.
  };
  explicit SurfaceFill(const Options& options) : options_(options) {}

  static constexpr std::uint32_t kNowhere = 0xFFFFFFFFU;

  /// Calls visit(pixel a, pixel b) for each pair of neighbors (in the row, the column or diagonally) that lie
  /// on one plane and in different voxels.
  /// @param cloud  Must be organized.
  /// @param places  For each pixel, an identifier of its voxel; kNowhere excludes the pixel.
  template <class Visitor>
  void ForEachPair(const PointCloud& cloud, std::span<const std::uint32_t> places, Visitor&& visit) const {
    constexpr std::pair<int, int> kSteps[] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}};
    const int width = cloud.width_px;
    for (const auto& [du, dv] : kSteps) {
      const int step = dv * width + du;
      for (int v = 0; v + dv < cloud.height_px; ++v) {
        const int first = v * width + std::max(0, -du);
        const int last = v * width + width - std::max(0, du);
        for (int a = first; a < last; ++a) {
          const std::uint32_t place_a = places[static_cast<std::size_t>(a)];
          const std::uint32_t place_b = places[static_cast<std::size_t>(a + step)];
          if (place_a == place_b || place_a == kNowhere || place_b == kNowhere) continue;
          if (!OnOnePlane(cloud, a - v * width, v, du, dv)) continue;
          visit(static_cast<std::size_t>(a), static_cast<std::size_t>(a + step));
        }
      }
    }
  }

 private:
  /// Whether pixels (u, v) and (u + du, v + dv) lie on one plane.
  bool OnOnePlane(const PointCloud& cloud, int u, int v, int du, int dv) const;

  Options options_;
};

}  // namespace thalweg::mapper
