#pragma once

#include <cmath>

#include "common/base/angles.h"

namespace thalweg {

/// What it takes to inspect a piece of surface: one view from near enough that is square enough to it.
struct InspectionCriterion {
  double distance = 2.0;              ///< [m]
  double max_angle = 60.0 * kDegree;  ///< [rad] Between the line of sight and the surface's normal.

  /// Cosine of max_angle: that of a view must be as large.
  double least_cosine() const { return std::cos(max_angle); }
};

}  // namespace thalweg
