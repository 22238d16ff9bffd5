#pragma once

#include <algorithm>

#include "common/geometry/pinhole_camera.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg {

/// The robot as the simulator moves it, the explorer plans for it and the controller steers it.
struct RobotModel {
  double radius = 0.10;    ///< [m] Of the sphere, or upright cylinder, about B's origin that holds it.
  double height = 0.0;     ///< [m] Of the cylinder, B's origin in its middle; 0 = a sphere.
  bool drives = false;     ///< In the plane it starts in, turning about the vertical only; else it flies.
  double max_speed = 0.5;  ///< [m/s]
  double max_acceleration = 1.0;  ///< [m/s^2]
  double max_turn_rate = 1.6;     ///< [rad/s] About any axis.
  RigidTransform T_BC = MakeTransform(BodyFromOptical(), Eigen::Vector3d::Zero());  ///< Camera in the body.
};

/// What a robot explores that starts there: all within the bounds, or the layer of them that the body of one
/// that drives sweeps. Empty when the start is above or below them.
inline Eigen::AlignedBox3d ExploredBounds(const RobotModel& robot, const Eigen::Vector3d& start_W,
                                          const Eigen::AlignedBox3d& bounds_W) {
  if (!robot.drives) return bounds_W;
  Eigen::AlignedBox3d layer = bounds_W;
  layer.min().z() = std::max(bounds_W.min().z(), start_W.z() - 0.5 * robot.height);
  layer.max().z() = std::min(bounds_W.max().z(), start_W.z() + 0.5 * robot.height);
  return layer;
}

/// The depth sensor as the simulator renders it and the explorer predicts what it will see.
struct DepthSensorModel {
  PinholeCamera camera = PinholeCamera::FromFieldOfView(100, 100, 1.3089969389957472);  ///< 75 deg
  double rate = 5.0;                                                                    ///< [Hz]
  double max_range = 8.0;           ///< [m] Along the ray; no measurement beyond.
  double disparity_noise_px = 0.0;  ///< [px] Sigma of the disparity measurement, then triangulated.
  double baseline = 0.12;           ///< [m] Of the stereo pair that the noise stands for.
  /// Where it measures nothing within max_range there is nothing, and it says so: IsNoReturn.
  bool no_return_is_free = false;
};

}  // namespace thalweg
