#pragma once

#include <optional>
#include <vector>

#include "services/visual_odometry/core/frame.h"
#include "services/visual_odometry/core/inverse_depth.h"

namespace thalweg::visual_odometry {

struct StereoMatcherOptions {
  /// Of the image's width. Large: a robot that looks about beside a wall sees nothing but what is near.
  double max_disparity = 0.7;
  float least_correlation = 0.8F;  ///< Of the aligned patches.
  float uniqueness = 0.85F;        ///< A match's SAD against that of its best rival on the row.
};

/// Finds points of the left image in the right one. Two uses: a first search along the whole row (SAD, then
/// alignment, then back again), and the alignment alone near where the point must be.
class StereoMatcher {
 public:
  /// Keeps references: `frame` outlives it.
  StereoMatcher(const Frame& frame, const Levels& levels, const StereoMatcherOptions& options);

  /// u_right, for a point about whose depth nothing is known.
  std::optional<double> Search(const Eigen::Vector2f& left);
  /// u_right, at most a few pixels from `expected`.
  std::optional<double> Refine(const Eigen::Vector2f& left, double expected) const;

 private:
  std::optional<double> RefineAs(const Eigen::Matrix2f& left_from_right, const Eigen::Vector2f& left,
                                 double expected) const;

  const Frame& frame_;
  Levels levels_;
  StereoMatcherOptions options_;
  cv::Mat left_search_;  ///< Made when they are first needed.
  cv::Mat right_search_;
};

}  // namespace thalweg::visual_odometry
