#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/visual_odometry/core/inverse_depth.h"

namespace thalweg::visual_odometry {

/// Consecutive keyframes and the points they observe. Poses are relative to each other, and each point is
/// relative to the keyframe that saw it first: there is no global origin [Sibley, Mei, Reid, Newman, Adaptive
/// Relative Bundle Adjustment, RSS 2009].
struct AdjustmentWindow {
  struct Observation {
    int keyframe = 0;  ///< >= the point's host.
    StereoPixel pixel;
    bool has_right = false;  ///< If false, pixel[2] is undefined.
  };
  struct Point {
    int host = 0;  ///< Keyframe in whose frame q is expressed.
    InverseDepthPoint q;
    std::vector<Observation> seen;
  };
  std::vector<RigidTransform> steps;  ///< steps[k] = T_{k+1,k}, from keyframe k to keyframe k + 1.
  std::vector<Point> points;
  std::vector<std::uint8_t> held;  ///< Whether each step is kept fixed; empty = none is.
};

struct AdjustmentOptions {
  int most_iterations = 5;
  double huber_px = 1.0;
};

/// T_{to,from} = steps[to - 1] ... steps[from], for from <= to.
RigidTransform ChainOf(const std::vector<RigidTransform>& steps, int from, int to);

/// The projection into keyframe `to` of a point of keyframe `from`, and its derivatives.
struct ChainJacobians {
  StereoPixel pixel;
  Eigen::Matrix3d by_point;
  std::vector<Eigen::Matrix<double, 3, 6>> by_step;  ///< By x of Moved(x, steps[from + k]) at x = 0.
  bool in_front = false;                             ///< If false, the other members are undefined.
};
ChainJacobians ProjectThroughChain(const StereoGeometry& rig, const std::vector<RigidTransform>& chain,
                                   const InverseDepthPoint& q);

/// Adjusts steps and points to minimize the reprojection errors (Huber loss), by Levenberg-Marquardt with the
/// points eliminated, using Ceres. The cost depends only on the window's size.
/// @return Root mean square error [px] afterwards.
double Adjust(const StereoGeometry& rig, AdjustmentWindow& window, const AdjustmentOptions& options);

/// What a window says about a systematic error of the disparities.
struct BiasEvidence {
  DisparityBias residual;       ///< c that remains in the window's pixels, as measured.
  Eigen::Matrix2d information;  ///< [1/px^2] Its inverse covariance; singular where it is not observable.
  /// [1/px^2] Information about a constant bias if the motion were known. How much larger it is than what is
  /// left says how much of a bias the motion would hide, and so how much other errors look like one.
  double with_known_motion = 0.0;
};

/// Measures the bias of disparities by which motion and disparity contradict each other: parallax grows in
/// proportion to inverse depth, so that a straight line through both must meet the origin, whatever the
/// scale.
///
/// One Gauss-Newton step of the adjustment with c as a further unknown, at its solution without; all steps of
/// the window and all points are eliminated. Each point has a matching error of its own, too, constant over
/// the frames that see it [random effect], since its picture looks different to the right camera in the same
/// way in each of them: more frames of the same points do not make c more certain than the points allow.
/// @param point_sigma_px  [px] Standard deviation of that error.
/// @return Nothing if the window has fewer than 20 points that were seen twice.
std::optional<BiasEvidence> EvidenceOfBias(const StereoGeometry& rig, const AdjustmentWindow& window,
                                           double point_sigma_px);

}  // namespace thalweg::visual_odometry
