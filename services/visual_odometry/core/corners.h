#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace thalweg::visual_odometry {

/// Detects corners that are spread evenly over the image. A quadtree divides the image, always splitting the
/// fullest leaf, until `target` leaves contain corners; each leaf then keeps its strongest corner, unless it
/// contains one of `taken`. The strength of a corner is the smaller eigenvalue of the gradients' covariance
/// [Shi, Tomasi, Good Features to Track, 1994].
/// @param image  CV_8UC1.
/// @param taken  [px] Existing corners.
/// @param target  Number of leaves, and so of corners, including the existing ones.
std::vector<Eigen::Vector2f> FindCorners(const cv::Mat& image, const std::vector<Eigen::Vector2f>& taken,
                                         int target);

}  // namespace thalweg::visual_odometry
