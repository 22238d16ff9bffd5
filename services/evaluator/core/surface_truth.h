#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/simulator/core/truth.h"
#include "services/simulator/core/world.h"

namespace thalweg::evaluator {

/// Points spread evenly over all true surface that a robot can observe, of the side from which it can.
///
/// A triangle has a random number of points with the mean kDensity times its area, at random places; a point
/// counts if some reachable position sees it within the map's range, by the test that decides which voxels of
/// free space are observable (simulator/core/visibility.h). With n points, a share p of the area is known to
/// sqrt(p (1 - p) / n).
struct SurfaceTruth {
  static constexpr double kDensity = 400.0;  ///< [1/m^2] One for each 5 x 5 cm.

  struct Point {
    Eigen::Vector3d p_W;
    Eigen::Vector3d normal_W;  ///< Unit length, toward the side that is observable.

    /// A point 1 mm before the surface, which the surface itself does not hide.
    Eigen::Vector3d before_W() const { return p_W + 1e-3 * normal_W; }
  };
  std::vector<Point> points;

  /// [m^2]
  double area() const { return static_cast<double>(points.size()) / kDensity; }

  /// O(area) visibility tests, on all cores.
  /// @param truth    Truth of that world, with the same options.
  /// @param start_W  Where the robot begins.
  static SurfaceTruth Of(const simulator::World& world, const simulator::TrueMap& truth,
                         const simulator::TrueMap::Options& options, const Eigen::Vector3d& start_W);
};

}  // namespace thalweg::evaluator
