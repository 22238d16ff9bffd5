#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace thalweg::visual_odometry {

/// Corners, spread evenly: the image is cut into a quadtree, always the fullest leaf into four, until it has
/// `target` leaves with something in them; each leaf keeps its strongest corner, unless it holds one of
/// `taken`. Strength is the smaller eigenvalue of the gradients' covariance [Shi, Tomasi, Good Features to
/// Track, 1994].
/// @param image  CV_8UC1.
/// @param taken  [px] Corners that are there already.
/// @param target  Leaves, so corners, taken ones included.
std::vector<Eigen::Vector2f> FindCorners(const cv::Mat& image, const std::vector<Eigen::Vector2f>& taken,
                                         int target);

}  // namespace thalweg::visual_odometry
