#pragma once

#include <vector>

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"
#include "services/visual_odometry/core/inverse_depth.h"

namespace thalweg::visual_odometry {

/// An estimated pose and the true pose of the same camera, each relative to its own origin.
struct PosePair {
  Time stamp;
  RigidTransform T_OC;
  RigidTransform T_WC_true;
  Matrix6d covariance = Matrix6d::Zero();  ///< The estimate's, as PoseEstimate::covariance.
};

/// Whether an error lies within the ellipsoid that should contain 95 % of errors.
struct Inside {
  bool position = false;
  bool rotation = false;
};
/// @param error       E in T_true = T * E.
/// @param covariance  Covariance of its (v, w); must be regular.
Inside InsideOf95Percent(const RigidTransform& error, const Matrix6d& covariance);

/// Mean relative error over all path segments of a given length, as in the KITTI benchmark [Geiger, Lenz,
/// Urtasun, CVPR 2012].
struct RelativeError {
  double length = 0.0;  ///< [m] Along the true path.
  int stretches = 0;
  double translation = 0.0;  ///< Mean of error / length.
  double rotation = 0.0;     ///< [rad/m]
};

struct TrajectoryError {
  int poses = 0;
  double path_length = 0.0;  ///< [m] Length of the true path.
  double ate_rmse = 0.0;     ///< [m] After the best rigid alignment of the positions [Horn 1987].
  double ate_max = 0.0;      ///< [m]
  double drift = 0.0;        ///< [m] Error of the last position if the first poses coincide.
  double drift_max = 0.0;    ///< [m] Largest such error of all positions.
  double drift_angle = 0.0;  ///< [rad] Error of the last orientation.
  /// Share of the poses with a covariance whose error relative to the first pose lies within the 95 %
  /// ellipsoid; NaN if there are none. Errors along one path are correlated, so a single flight amounts to
  /// few samples.
  double inside_position = 0.0;
  double inside_rotation = 0.0;
  /// For lengths 100, 200 ... 800 m as in the benchmark; for a path shorter than 100 m, multiples of 10 m
  /// that fit (or of 1 m, up to 8 m, if it is shorter than 10 m).
  std::vector<RelativeError> by_length;
  /// Means over all segments of all lengths; NaN if none fits.
  double relative_translation = 0.0;
  double relative_rotation = 0.0;  ///< [rad/m]
};

/// Throws std::invalid_argument if there are fewer than two poses.
TrajectoryError Compare(const std::vector<PosePair>& poses);

}  // namespace thalweg::visual_odometry
