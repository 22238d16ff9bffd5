#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <optional>

#include "common/geometry/pinhole_camera.h"

namespace thalweg::visual_odometry {

/// The rotation that best turns one small image into the next, from all their pixels, as if everything were
/// far away [Mei, Benhimane, Malis, Rives: Homography-based tracking, 2006; used so by Mei, Sibley, Newman
/// 2011]. Translation blurs it, so it is a prediction, not a measurement.
/// @param before, after  CV_8UC1, some ten pixels in size, of the same camera `camera` (already scaled to
/// them).
/// @param R_start  First guess of R_AB: the camera before (B) as seen from after (A).
/// @return  R_AB, or nothing when it does not settle.
std::optional<Eigen::Matrix3d> PredictRotation(const cv::Mat& before, const cv::Mat& after,
                                               const PinholeCamera& camera, const Eigen::Matrix3d& R_start);

/// Of what the guesses settle to, and the first of them as it is, what leaves the least difference.
Eigen::Matrix3d BestRotation(const cv::Mat& before, const cv::Mat& after, const PinholeCamera& camera,
                             const std::array<Eigen::Matrix3d, 2>& guesses);

/// Mean absolute difference [grey values] that is left between the two under that rotation, after their mean
/// difference is taken out.
double RotationError(const cv::Mat& before, const cv::Mat& after, const PinholeCamera& camera,
                     const Eigen::Matrix3d& R_AB);

/// The camera of an image made `levels` times half as large by cv::pyrDown.
PinholeCamera ScaledDown(const PinholeCamera& camera, int levels);

}  // namespace thalweg::visual_odometry
