#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>

#include "services/stereo/core/image.h"

namespace thalweg::stereo {

/// By how much the rows of two rectified images differ that should be the same: what a calibration is off by
/// that is no longer right, because a lens or a mount has moved. A single pair shows only this; an error of
/// the disparities themselves needs known distances or motion.
///
/// The right image shows at row v + offset + tilt x + slant y what the left one shows at row v, where x and y
/// go from -0.5 to 0.5 across the image.
struct RowAlignment {
  std::size_t corners = 0;  ///< How many were found in both images and agree with this model.
  double offset_px = 0.0;   ///< At the image's center.
  double tilt_px = 0.0;     ///< By how much more at the right border than at the left one.
  double slant_px = 0.0;    ///< By how much more at the lower border than at the upper one.
  Eigen::Matrix3d covariance_px2 = Eigen::Matrix3d::Zero();  ///< For (offset, tilt, slant).

  double AtPx(double x, double y) const { return offset_px + tilt_px * x + slant_px * y; }
  /// [px] The largest difference in the image, less three standard deviations; at least 0.
  double CertainPx() const;
};

/// [px] Rows that differ by more lose matches and bend disparities at slanted edges.
inline constexpr double kMostRowDifference = 0.5;

/// Measures it at corners of the left image, of which normalized correlation finds the place in the right
/// one. Differences up to 6 px are found. Nothing if too few corners agree.
/// @param left, right  Gray, rectified.
/// @param max_disparity  [px] Disparities below it are searched.
std::optional<RowAlignment> MeasureRowAlignment(const ByteImage& left, const ByteImage& right,
                                                int max_disparity);

/// "rows agree within 0.1 px (312 corners)", or by how much they differ and what to do; for people.
std::string Describe(const RowAlignment& rows);

/// Decides from pair after pair whether to warn: not by a single one.
class RowMonitor {
 public:
  /// @return A line for people when the rows have begun to differ, or to agree again.
  std::optional<std::string> Add(const RowAlignment& rows);

 private:
  static constexpr int kPairs = 3;  ///< How many must say the same in a row.
  bool warned_ = false;
  int against_ = 0;  ///< Pairs in a row that speak against warned_.
};

}  // namespace thalweg::stereo
