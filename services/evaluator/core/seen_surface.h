#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/pinhole_camera.h"
#include "common/geometry/rigid_transform.h"
#include "services/evaluator/core/surface_truth.h"
#include "services/surface/core/fused/view_quality.h"

namespace thalweg::evaluator {

/// Notes which part of the true surface a camera has seen, and how well.
/// Threading: one thread.
class SeenSurface {
 public:
  /// @param world, truth  Must outlive this.
  /// @param max_range     [m] What is farther is not seen.
  SeenSurface(const simulator::World& world, const SurfaceTruth& truth, const PinholeCamera& camera,
              double max_range, const surface::InspectionLimits& limits);

  /// Takes note of a view. @param T_WC  The camera's true pose.
  void Note(const RigidTransform& T_WC);

  // Shares of the observable surface.
  double seen() const;       ///< In view, with nothing in between.
  double inspected() const;  ///< Seen near and square enough by one view.
  double fine() const;       ///< Sampled finely enough by a view.

 private:
  double Share(unsigned what) const;

  const simulator::World& world_;
  const SurfaceTruth& truth_;
  PinholeCamera camera_;
  double max_range_;
  surface::InspectionLimits limits_;
  std::vector<std::uint8_t> seen_;  ///< For each point of the truth, bits of how well.
};

}  // namespace thalweg::evaluator
