#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/visual_odometry/core/inverse_depth.h"

namespace thalweg::visual_odometry {

/// A known point of the keyframe K and where the camera C sees it.
struct PosePoint {
  InverseDepthPoint q_K;
  Eigen::Matrix3d q_covariance;  ///< For pixel errors of 1 px.
  StereoPixel pixel;
  bool has_right = false;  ///< Else pixel[2] means nothing.
};

struct PoseSolution {
  RigidTransform T_CK;
  /// Of x in T_CK_true = Moved(x, T_CK), x = (v, w) [m, rad]: pixel errors and the points' own.
  Matrix6d covariance;
  std::vector<std::uint8_t> inlier;  ///< One a point.
  int inliers = 0;
  double sigma_px = 0.0;  ///< Of one pixel coordinate, as the inliers' residuals show it.
};

struct PoseSolverOptions {
  int most_hypotheses = 150;
  double ransac_threshold_px = 2.0;
  double gate = 3.8;            ///< Sigmas beyond which a point is no inlier: 99.8 % in three dimensions.
  double least_sigma_px = 0.1;  ///< Residuals of few points can be small by chance.
};

/// The pose with the most inliers of hypotheses from three points each [Fischler, Bolles 1981; Ke,
/// Roumeliotis, An Efficient Algebraic Solution to the Perspective-Three-Point Problem, CVPR 2017]; left
/// image only.
/// @param T_CK_predicted  A hypothesis, too.
/// @return  Nothing with fewer than four points or inliers. Deterministic for a seed.
struct Consensus {
  RigidTransform T_CK;
  std::vector<std::uint8_t> inlier;
  int inliers = 0;
};
std::optional<Consensus> FindConsensus(const StereoGeometry& rig, const std::vector<PosePoint>& points,
                                       const RigidTransform& T_CK_predicted, const PoseSolverOptions& options,
                                       std::uint64_t seed);

/// The pose that minimises the reprojection errors, each weighted by its covariance, robustly (Huber, then a
/// gate). @param sigma_px  What the pixel error was so far; the residuals correct it.
/// @return  Nothing when the points do not fix six degrees of freedom.
std::optional<PoseSolution> SolvePose(const StereoGeometry& rig, const std::vector<PosePoint>& points,
                                      const RigidTransform& T_CK_start, double sigma_px,
                                      const PoseSolverOptions& options);

}  // namespace thalweg::visual_odometry
