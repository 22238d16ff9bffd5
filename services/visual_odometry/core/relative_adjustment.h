#pragma once

#include <cstdint>
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

}  // namespace thalweg::visual_odometry
