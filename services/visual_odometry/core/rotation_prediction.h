#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <optional>

#include "common/geometry/pinhole_camera.h"

namespace thalweg::visual_odometry {

/// The rotation that best aligns one small image with the next, using all pixels as if everything were far
/// away [Mei, Benhimane, Malis, Rives: Homography-based tracking, 2006; used likewise by Mei, Sibley, Newman
/// 2011]. Translation biases it, so it is a prediction, not a measurement.
/// @param before, after  CV_8UC1, some tens of pixels wide, seen by `camera` (scaled to this size).
/// @param R_start  Initial guess of R_AB: from the camera before (B) to the camera after (A).
/// @return R_AB, or nothing if it does not converge.
std::optional<Eigen::Matrix3d> PredictRotation(const cv::Mat& before, const cv::Mat& after,
                                               const PinholeCamera& camera, const Eigen::Matrix3d& R_start);

/// The rotation with the smallest remaining difference, among the first guess as it is and what each guess
/// converges to.
Eigen::Matrix3d BestRotation(const cv::Mat& before, const cv::Mat& after, const PinholeCamera& camera,
                             const std::array<Eigen::Matrix3d, 2>& guesses);

/// Mean absolute difference [gray values] between the two images under the rotation, after removing the
/// difference of their means.
double RotationError(const cv::Mat& before, const cv::Mat& after, const PinholeCamera& camera,
                     const Eigen::Matrix3d& R_AB);

/// The camera for an image halved in size `levels` times by cv::pyrDown.
PinholeCamera ScaledDown(const PinholeCamera& camera, int levels);

}  // namespace thalweg::visual_odometry
