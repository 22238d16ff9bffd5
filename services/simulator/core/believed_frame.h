#pragma once

#include <deque>

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg::simulator {

/// The map of a robot that goes by an odometry of its own, against the true world: a robot moves to where it
/// believes the commanded pose to be, so its drift is in its motion, too.
class BelievedFrame {
 public:
  /// The truth of that moment; the newest last.
  void Note(Time stamp, const RigidTransform& T_WB_true);
  /// What the odometry says of a moment; nothing changes when that was too long ago.
  void Believe(Time stamp, const RigidTransform& T_WB);
  /// Where it goes when it is sent there.
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
