#pragma once

#include <cstddef>
#include <optional>

#include "common/geometry/rigid_transform.h"
#include "common/geometry/robot_model.h"

namespace thalweg::explorer {

/// Where a robot looks that knows no free space around itself: it turns on the spot by one step after the
/// other, and each full round looks higher or lower than the one before.
class BlindLook {
 public:
  /// The next orientation R_WB; empty when it has looked everywhere.
  /// @param robot  One that is level does not look up and down, one with a gimbal as far as that goes.
  std::optional<Eigen::Matrix3d> Next(const Eigen::Matrix3d& R_WB, const RobotModel& robot);
  /// Begins again, since free space is known.
  void Reset() { looks_ = 0; }

 private:
  std::size_t looks_ = 0;
};

}  // namespace thalweg::explorer
