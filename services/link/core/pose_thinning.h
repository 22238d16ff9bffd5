#pragma once

#include <optional>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"
#include "services/link/core/packing.h"

namespace thalweg::link {

/// Passes no more than one message in a period of the stamps.
class RateLimit {
 public:
  explicit RateLimit(Duration period) : period_(period) {}
  bool Passes(Time stamp);

 private:
  Duration period_;
  std::optional<Time> last_;
};

/// Leaves out poses that a reader can interpolate from those that pass.
///
/// Threading: one thread.
class PoseThinning {
 public:
  struct Options {
    Duration period = std::chrono::milliseconds(50);  ///< A pose passes once this has gone by since the last.
    /// Where interpolation between those that pass were off by more than one of these, more pass.
    double position = 1e-3;  ///< [m]
    double angle = 5e-4;     ///< [rad]
  };
  explicit PoseThinning(const Options& options) : options_(options) {}

  /// Takes the next pose with the message that states it, and returns the messages that pass now, in order.
  std::vector<Buffer> Add(Time stamp, const RigidTransform& T, Buffer message);

 private:
  struct Pose {
    Time stamp;
    RigidTransform T;
  };
  bool CanSkipUntil(const Pose& pose) const;

  Options options_;
  std::optional<Pose> passed_;
  std::vector<Pose> skipped_;  ///< Since then.
  Buffer last_skipped_;        ///< Message of the last of them.
};

}  // namespace thalweg::link
