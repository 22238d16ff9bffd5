#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/visual_odometry/core/inverse_depth.h"

namespace thalweg::visual_odometry {

/// A known point in the frame of keyframe K, and where camera C sees it.
struct PosePoint {
  InverseDepthPoint q_K;
  Eigen::Matrix3d q_covariance;  ///< For pixel errors of 1 px.
  StereoPixel pixel;
  bool has_right = false;  ///< If false, pixel[2] is undefined.
};

struct PoseSolution {
  RigidTransform T_CK;
  /// Covariance of x in T_CK_true = Moved(x, T_CK), x = (v, w) [m, rad]: from pixel errors and the points'
  /// own.
  Matrix6d covariance;
  std::vector<std::uint8_t> inlier;  ///< One flag per point.
  int inliers = 0;
  /// Standard deviation of a pixel coordinate, estimated from the inliers' residuals.
  double sigma_px = 0.0;
  /// d x / d c, with x as above and c the bias that is assumed of the disparities, of K as of C.
  Matrix62d by_bias = Matrix62d::Zero();
  /// Relative change of the points' inverse depths by c [1/px], each point weighted as it determines the
  /// translation, by the square of its disparity.
  Eigen::Vector2d scale_by_bias = Eigen::Vector2d::Zero();
};

struct PoseSolverOptions {
  int most_hypotheses = 150;
  double ransac_threshold_px = 2.0;
  double gate = 3.8;            ///< [sigmas] Largest residual of an inlier: 99.8 % in three dimensions.
  double least_sigma_px = 0.1;  ///< Lower limit, since residuals of few points can be small by chance.
};

/// The pose with the most inliers among hypotheses from three points each [Fischler, Bolles 1981; Ke,
/// Roumeliotis, An Efficient Algebraic Solution to the Perspective-Three-Point Problem, CVPR 2017]; uses the
/// left image only.
/// @param T_CK_predicted  Considered as a hypothesis, too.
/// @return Nothing if there are fewer than four points or inliers. Deterministic for a given seed.
struct Consensus {
  RigidTransform T_CK;
  std::vector<std::uint8_t> inlier;
  int inliers = 0;
};
std::optional<Consensus> FindConsensus(const StereoGeometry& rig, const std::vector<PosePoint>& points,
                                       const RigidTransform& T_CK_predicted, const PoseSolverOptions& options,
                                       std::uint64_t seed);

/// The pose that minimizes the reprojection errors, each weighted by its covariance, robustly (Huber loss,
/// then a gate).
/// @param sigma_px  Pixel error so far, updated from the residuals.
/// @return Nothing if the points do not determine all six degrees of freedom.
std::optional<PoseSolution> SolvePose(const StereoGeometry& rig, const std::vector<PosePoint>& points,
                                      const RigidTransform& T_CK_start, double sigma_px,
                                      const PoseSolverOptions& options);

}  // namespace thalweg::visual_odometry
