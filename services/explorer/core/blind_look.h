#pragma once

#include <cstddef>
#include <optional>

#include "common/geometry/rigid_transform.h"

namespace thalweg::explorer {

/// Where a robot looks that knows no free space around itself: it turns on the spot by one step after the
/// other, and each full round looks higher or lower than the one before.
class BlindLook {
 public:
  /// The next orientation R_WB; empty when it has looked everywhere.
  /// @param level  Whether the robot cannot look up and down.
  std::optional<Eigen::Matrix3d> Next(const Eigen::Matrix3d& R_WB, bool level);
  /// Begins again, since free space is known.
  void Reset() { looks_ = 0; }

 private:
  std::size_t looks_ = 0;
};

}  // namespace thalweg::explorer
