#pragma once

#include <deque>

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg::simulator {

/// Relates the frame in which a robot believes itself to be (that of its own odometry) to the true world. The
/// robot moves to where it believes the commanded pose to be, so odometry drift shows up in its motion.
class BelievedFrame {
 public:
  /// Records the true pose at a time. Times must increase from call to call.
  void Note(Time stamp, const RigidTransform& T_WB_true);
  /// Records the pose that the odometry reports for a time. Ignored unless the true pose at exactly that time
  /// is among those noted during the last two seconds.
  void Believe(Time stamp, const RigidTransform& T_WB);
  /// The true pose that the robot reaches when commanded to a pose in its own frame.
  RigidTransform TrueOf(const RigidTransform& T_WB) const { return T_true_believed_ * T_WB; }

 private:
  struct Moment {
    Time stamp;
    RigidTransform T_WB_true;
  };
  std::deque<Moment> moments_;
  RigidTransform T_true_believed_ = RigidTransform::Identity();
};

}  // namespace thalweg::simulator
