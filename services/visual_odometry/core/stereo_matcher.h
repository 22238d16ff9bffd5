#pragma once

#include <optional>
#include <vector>

#include "services/visual_odometry/core/frame.h"
#include "services/visual_odometry/core/inverse_depth.h"

namespace thalweg::visual_odometry {

struct StereoMatcherOptions {
  /// Share of the image's width. Large, since a robot that looks around beside a wall sees only what is near.
  double max_disparity = 0.7;
  float least_correlation = 0.8F;  ///< Correlation of the aligned patches.
  float uniqueness = 0.85F;        ///< Largest SAD of a match relative to that of its best rival in the row.
};

/// Finds points of the left image in the right one: either by a search along the whole row (SAD, then
/// alignment, then a check by matching back), or by alignment alone near an expected position.
class StereoMatcher {
 public:
  /// Keeps a reference to `frame`, which must outlive the matcher.
  /// @param row_offset  [px] v_right - v_left of the same point, 0 for a calibration that is good.
  StereoMatcher(const Frame& frame, const Levels& levels, const StereoMatcherOptions& options,
                double row_offset = 0.0);

  /// u_right of a point of unknown depth.
  std::optional<double> Search(const Eigen::Vector2f& left);
  /// u_right, at most a few pixels from `expected`.
  std::optional<double> Refine(const Eigen::Vector2f& left, double expected);
  /// [px] v_right - v_left of the points so far, also of those refused for it.
  const std::vector<double>& row_offsets() const { return row_offsets_; }

 private:
  std::optional<double> RefineAs(const Eigen::Matrix2f& left_from_right, const Eigen::Vector2f& left,
                                 double expected);

  const Frame& frame_;
  Levels levels_;
  StereoMatcherOptions options_;
  float row_offset_;
  std::vector<double> row_offsets_;
  cv::Mat left_search_;  ///< Created on first use.
  cv::Mat right_search_;
};

}  // namespace thalweg::visual_odometry
