#pragma once

#include <Eigen/Core>
#include <cmath>
#include <utility>

#include "common/geometry/point_cloud.h"

namespace thalweg::mapper {

/// Finds neighbouring pixels between which a surface goes on, so that the map can close the gaps between the
/// points of a sparse or grazing view. A plane's inverse depth is linear in pixel coordinates: two neighbours
/// belong to one plane when the second difference of inverse depth, over them and the next pixel before or
/// after them on the same line, vanishes.
class SurfaceFill {
 public:
  struct Options {
    double min_gap = 0.07;     ///< [m] Nearer points leave no voxel between them.
    double max_gap = 0.4;      ///< [m]
    double tolerance = 0.004;  ///< Of the second difference, relative to the inverse depth.
  };
  explicit SurfaceFill(const Options& options) : options_(options) {}

  /// Calls visit(pixel a, pixel b) for each pair of neighbours (in the row, the column or diagonally) on one
  /// plane. @param cloud  Organised; one of height 1 has no neighbours.
  template <class Visitor>
  void ForEachPair(const PointCloud& cloud, Visitor&& visit) const {
    if (cloud.height_px < 2 || cloud.width_px < 2) return;
    constexpr std::pair<int, int> kSteps[] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}};
    for (int v = 0; v < cloud.height_px; ++v) {
      for (int u = 0; u < cloud.width_px; ++u) {
        for (const auto& [du, dv] : kSteps) {
          const int u_b = u + du;
          const int v_b = v + dv;
          if (u_b < 0 || u_b >= cloud.width_px || v_b >= cloud.height_px) continue;
          if (OnOnePlane(cloud, u, v, du, dv)) visit(Pixel(cloud, u, v), Pixel(cloud, u_b, v_b));
        }
      }
    }
  }

 private:
  static std::size_t Pixel(const PointCloud& cloud, int u, int v) {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(cloud.width_px) +
           static_cast<std::size_t>(u);
  }
  /// Whether pixels (u, v) and (u + du, v + dv) are.
  bool OnOnePlane(const PointCloud& cloud, int u, int v, int du, int dv) const;

  Options options_;
};

}  // namespace thalweg::mapper
