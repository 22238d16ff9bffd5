#pragma once

#include <cstdint>
#include <vector>

#include "services/visual_odometry/core/inverse_depth.h"

namespace thalweg::visual_odometry {

/// Some keyframes in a row and the points they see. Poses are relative to each other, points to the keyframe
/// that saw them first: there is no origin [Sibley, Mei, Reid, Newman, Adaptive Relative Bundle Adjustment,
/// RSS 2009].
struct AdjustmentWindow {
  struct Observation {
    int keyframe = 0;  ///< >= the point's host.
    StereoPixel pixel;
    bool has_right = false;  ///< Else pixel[2] means nothing.
  };
  struct Point {
    int host = 0;  ///< Keyframe whose frame q is in.
    InverseDepthPoint q;
    std::vector<Observation> seen;
  };
  std::vector<RigidTransform> steps;  ///< steps[k] = T of keyframe k + 1 from keyframe k: T_{k+1,k}.
  std::vector<Point> points;
  std::vector<std::uint8_t> held;  ///< Whether a step is settled, one a step; empty = none is.
};

struct AdjustmentOptions {
  int most_iterations = 5;
  double huber_px = 1.0;
};

/// T_{to,from} = steps[to - 1] ... steps[from]. from <= to.
RigidTransform ChainOf(const std::vector<RigidTransform>& steps, int from, int to);

/// Derivatives of where keyframe `to` sees a point of keyframe `from`.
struct ChainJacobians {
  StereoPixel pixel;
  Eigen::Matrix3d by_point;
  std::vector<Eigen::Matrix<double, 3, 6>> by_step;  ///< Of Moved(x, steps[from + k]) at x = 0.
  bool in_front = false;                             ///< Else the rest means nothing.
};
ChainJacobians ProjectThroughChain(const StereoGeometry& rig, const std::vector<RigidTransform>& chain,
                                   const InverseDepthPoint& q);

/// Moves steps and points to where the reprojection errors (Huber) are least; Levenberg-Marquardt with the
/// points eliminated, by Ceres. Cost grows with the window alone. @return  RMS error [px] afterwards.
double Adjust(const StereoGeometry& rig, AdjustmentWindow& window, const AdjustmentOptions& options);

}  // namespace thalweg::visual_odometry
