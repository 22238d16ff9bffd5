#pragma once

namespace thalweg::visual_odometry {

/// The standard deviation of one coordinate by the length of a single residual. The median length of a
/// normally distributed residual is 1.538 standard deviations in three dimensions and 1.177 in two, so that
/// the median of what many residuals give is their standard deviation, regardless of outliers.
/// @param dimensions  2 or 3.
inline double SigmaByLength(double length, int dimensions) {
  return length / (dimensions == 3 ? 1.538 : 1.177);
}

}  // namespace thalweg::visual_odometry
