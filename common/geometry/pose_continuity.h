#pragma once

#include <optional>

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"
#include "common/geometry/robot_model.h"

namespace thalweg {

/// Separates poses that a robot can have reached from those that jump. A pose that jumps is not used; if the
/// next one follows on it, it is the old ones that are no longer valid.
class PoseContinuity {
 public:
  struct Options {
    double max_speed = 1.0;      ///< [m/s]
    double max_turn_rate = 3.0;  ///< [rad/s]
    double allowance = 0.05;     ///< [m], [rad] What a pose may be off.

    /// Poses may be twice as fast as the robot is said to be.
    static Options For(const RobotModel& robot) {
      return {.max_speed = 2.0 * robot.max_speed, .max_turn_rate = 2.0 * robot.greatest_turn_rate()};
    }
  };
  enum class Verdict {
    kFollows,   ///< It follows on those before.
    kJumps,     ///< It does not.
    kNewTrack,  ///< It follows on the one that jumped: poses before that are of no use.
  };

  explicit PoseContinuity(const Options& options) : options_(options) {}

  /// @param stamp  Later than that of the pose before, or else time has jumped and Forget() was called.
  Verdict Judge(Time stamp, const RigidTransform& T_WB) {
    const Stamped pose{stamp, T_WB};
    if (!last_ || Follows(*last_, pose)) {
      last_ = pose;
      jumped_.reset();
      return Verdict::kFollows;
    }
    if (jumped_ && Follows(*jumped_, pose)) {
      last_ = pose;
      jumped_.reset();
      return Verdict::kNewTrack;
    }
    jumped_ = pose;
    return Verdict::kJumps;
  }
  void Forget() {
    last_.reset();
    jumped_.reset();
  }

 private:
  struct Stamped {
    Time stamp;
    RigidTransform T_WB;
  };
  bool Follows(const Stamped& a, const Stamped& b) const {
    const double seconds = Seconds(b.stamp - a.stamp);
    return (b.T_WB.translation() - a.T_WB.translation()).norm() <=
               options_.max_speed * seconds + options_.allowance &&
           AngleBetween(a.T_WB, b.T_WB) <= options_.max_turn_rate * seconds + options_.allowance;
  }

  Options options_;
  std::optional<Stamped> last_;
  std::optional<Stamped> jumped_;
};

}  // namespace thalweg
