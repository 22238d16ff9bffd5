#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/pinhole_camera.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg {

/// Which orientations a body can take.
enum class Attitude {
  kFree,   ///< Any: turns about any axis at the same rate.
  kLevel,  ///< Upright, as a multirotor that moves slowly: turns about the vertical only.
  /// Upright, too, with a camera on a gimbal, which pitches. B is what the gimbal carries: its heading is the
  /// robot's, its pitch the gimbal's.
  kGimbal,
};

/// How a robot that drives can move.
enum class Drive {
  kOmni,          ///< In any direction, whatever its heading, as on mecanum wheels.
  kDifferential,  ///< Only where it faces, or straight back; it turns on the spot.
  kAckermann,     ///< The same, but it turns only as it moves, as a car; B's origin is on its rear axle.
};

/// The robot that the simulator moves, the explorer plans for and the controller steers.
struct RobotModel {
  double radius = 0.10;  ///< [m] Radius of the bounding sphere, or upright cylinder, around B's origin.
  double height = 0.0;   ///< [m] Height of the cylinder, centered at B's origin; 0 = a sphere.
  Attitude attitude = Attitude::kFree;
  /// Drives in the plane it starts in, and is level, whatever its attitude says; else it flies.
  bool drives = false;
  Drive drive = Drive::kOmni;          ///< Matters only if it drives.
  double min_turning_radius = 0.0;     ///< [m] On which B of kAckermann can move; else 0.
  double max_speed = 0.5;              ///< [m/s]
  double max_acceleration = 1.0;       ///< [m/s^2] Along its path and across it, together.
  double max_jerk = 0.0;               ///< [m/s^3] Greatest change of the acceleration; 0 = any.
  double max_turn_rate = 1.6;          ///< [rad/s] About any axis that it can turn about.
  double max_turn_acceleration = 4.0;  ///< [rad/s^2]
  // The gimbal's limits.
  double gimbal_lowest = -0.5 * std::numbers::pi;   ///< [rad] Pitch; positive upward.
  double gimbal_highest = std::numbers::pi / 6.0;   ///< [rad]
  double max_gimbal_rate = std::numbers::pi / 3.0;  ///< [rad/s]
  /// Pose of the camera in the body.
  RigidTransform T_BC = MakeTransform(BodyFromOptical(), Eigen::Vector3d::Zero());

  /// Whether it turns about the vertical only.
  bool level() const { return drives || attitude == Attitude::kLevel; }
  bool gimballed() const { return !drives && attitude == Attitude::kGimbal; }
  /// Whether it turns about any axis.
  bool turns_freely() const { return !drives && attitude == Attitude::kFree; }
  /// [rad] The pitch nearest to the given one that it can have without roll.
  double PitchWithin(double pitch) const {
    return level() ? 0.0 : gimballed() ? std::clamp(pitch, gimbal_lowest, gimbal_highest) : pitch;
  }
  /// [rad/s] About all axes together.
  double greatest_turn_rate() const {
    return gimballed() ? std::hypot(max_turn_rate, max_gimbal_rate) : max_turn_rate;
  }
  /// [s] Over which a motion within max_acceleration must be averaged to have no more than max_jerk: the
  /// acceleration may turn about at once.
  double smoothing() const { return max_jerk > 0.0 ? 2.0 * max_acceleration / max_jerk : 0.0; }
  /// Whether it moves only where it faces, or straight back.
  bool faces_travel() const { return drives && drive != Drive::kOmni; }
  bool turns_on_the_spot() const { return !drives || drive != Drive::kAckermann; }
};

/// The part of the bounds that a robot starting at `start_W` explores: all of it, or for a robot that drives,
/// the layer that its body sweeps. Empty if the start is above or below the bounds.
inline Eigen::AlignedBox3d ExploredBounds(const RobotModel& robot, const Eigen::Vector3d& start_W,
                                          const Eigen::AlignedBox3d& bounds_W) {
  if (!robot.drives) return bounds_W;
  Eigen::AlignedBox3d layer = bounds_W;
  layer.min().z() = std::max(bounds_W.min().z(), start_W.z() - 0.5 * robot.height);
  layer.max().z() = std::min(bounds_W.max().z(), start_W.z() + 0.5 * robot.height);
  return layer;
}

/// The depth sensor that the simulator renders, and whose view the explorer predicts.
struct DepthSensorModel {
  PinholeCamera camera = PinholeCamera::FromFieldOfView(100, 100, 1.3089969389957472);  ///< 75 deg
  double rate = 5.0;                                                                    ///< [Hz]
  double max_range = 8.0;  ///< [m] Along the ray; nothing beyond is measured.
  /// [px] Standard deviation of the disparity from which depth is triangulated.
  double disparity_noise_px = 0.0;
  /// [px] Standard deviation, along rows and columns each, of where a point is in the left image.
  double image_noise_px = 0.0;
  double baseline = 0.12;  ///< [m] Baseline of the stereo pair that the noise stands for.
  /// Whether the sensor reports rays that meet nothing within max_range as IsNoReturn.
  bool no_return_is_free = false;
};

}  // namespace thalweg
