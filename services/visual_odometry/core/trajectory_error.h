#pragma once

#include <vector>

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"
#include "services/visual_odometry/core/inverse_depth.h"

namespace thalweg::visual_odometry {

/// A pose and what it is in truth, both of the same camera, each against an origin of its own.
struct PosePair {
  Time stamp;
  RigidTransform T_OC;
  RigidTransform T_WC_true;
  Matrix6d covariance = Matrix6d::Zero();  ///< Of the pose, as PoseEstimate::covariance.
};

/// Whether an error lies within the ellipsoid that should hold 95 % of them.
struct Inside {
  bool position = false;
  bool rotation = false;
};
/// @param error  E in T_true = T * E.  @param covariance  Of its (v, w); regular.
Inside InsideOf95Percent(const RigidTransform& error, const Matrix6d& covariance);

/// Relative error over all stretches of that length, as the KITTI benchmark has it [Geiger, Lenz, Urtasun,
/// CVPR 2012].
struct RelativeError {
  double length = 0.0;  ///< [m] Along the true path.
  int stretches = 0;
  double translation = 0.0;  ///< Mean of error / length.
  double rotation = 0.0;     ///< [rad/m]
};

struct TrajectoryError {
  int poses = 0;
  double path_length = 0.0;  ///< [m] True.
  double ate_rmse = 0.0;     ///< [m] After the best rigid alignment of the positions [Horn 1987].
  double ate_max = 0.0;      ///< [m]
  double drift = 0.0;        ///< [m] Of the last position, when the first poses are laid on each other.
  double drift_max = 0.0;    ///< [m] The largest of all positions.
  double drift_angle = 0.0;  ///< [rad] Of the last orientation.
  /// Share of the poses, of those with a covariance, whose error since the first one lies within the 95 %
  /// ellipsoid; NaN when there are none. Errors along one way go together: one flight is few samples.
  double inside_position = 0.0;
  double inside_rotation = 0.0;
  /// 100, 200 ... 800 m as in the benchmark; for a path shorter than 100 m, the whole tens of metres that fit
  /// (1 ... 8 m for one shorter than 10 m).
  std::vector<RelativeError> by_length;
  /// Means over all stretches of all lengths; NaN when none fits.
  double relative_translation = 0.0;
  double relative_rotation = 0.0;  ///< [rad/m]
};

/// Throws std::invalid_argument with fewer than two poses.
TrajectoryError Compare(const std::vector<PosePair>& poses);

}  // namespace thalweg::visual_odometry
