#pragma once

#include "common/geometry/rigid_transform.h"
#include "common/geometry/stereo_geometry.h"
#include "services/visual_odometry/core/frame.h"

namespace thalweg::visual_odometry::test {

/// The inside of a box of 6 x 5 x 3 m whose walls carry a smooth texture. Rendered exactly, at little cost,
/// from a camera anywhere in it.
class TexturedRoom {
 public:
  /// @param contrast  1 = gray values from about 40 to 220; 0 = uniform.
  /// @param noise     [gray values] Standard deviation.
  /// @param period    [m] Period of the pattern along x; 0 = not periodic.
  explicit TexturedRoom(double contrast = 1.0, double noise = 1.0, double period = 0.0)
      : contrast_(contrast), noise_(noise), period_(period) {}

  cv::Mat See(const PinholeCamera& camera, const RigidTransform& T_WC, std::uint64_t seed) const;
  StereoImages SeePair(const StereoGeometry& rig, const RigidTransform& T_WC, Time stamp) const;

 private:
  double contrast_;
  double noise_;
  double period_;
};

/// 320 x 240, 70 degrees, 0.12 m baseline.
StereoGeometry SmallRig();

/// The camera at the center of the room, looking along W's x axis, after `step` steps of 2.5 cm forwards with
/// a slow turn.
RigidTransform RoomPose(int step);
Time RoomStamp(int step);  ///< 20 Hz

}  // namespace thalweg::visual_odometry::test
