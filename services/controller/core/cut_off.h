#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/flown_path.h"

namespace thalweg::controller {

/// What a robot does when it has not heard its explorer for a while.
enum class OnCutOff : std::uint8_t {
  kStand,
  kRetreat,  ///< Goes back to where the explorer was last heard, and then farther back, step by step.
  kHome,     ///< Goes back to where its path began.
  kGoOn,     ///< Goes on to the end of its path, see PathFollower.
};

/// Where a robot that is cut off goes back to, or waits.
enum class BackPlace : std::uint8_t {
  kLastHeard,           ///< Where the explorer was last heard.
  kFartherBack,         ///< Farther back on the path that it came.
  kBeginning,           ///< Where its path began.
  kFarthestRemembered,  ///< As far back as it remembers its path.
};

/// Decides when and how far a robot that is cut off from its explorer goes back. It moves only along the path
/// on which it came, which was free when it passed.
///
/// Threading: one thread.
class CutOff {
 public:
  struct Options {
    OnCutOff action = OnCutOff::kStand;
    double after = 5.0;  ///< [s] Silence until the robot goes back, and when retreating, farther back.
    double step = 2.0;   ///< [m] How far each time, after the first.
  };
  /// Throws std::invalid_argument naming the invalid option.
  explicit CutOff(const Options& options);

  /// Records a pose of the robot, while it follows a path or stands.
  void Note(const RigidTransform& T_WB) { flown_.Note(T_WB); }
  /// The explorer was heard. Its path is followed again, or goes on.
  void Heard(Time now);
  /// The path back, from the robot, if it is time to take one.
  std::optional<std::vector<RigidTransform>> PathBack(Time now);
  /// The robot has followed the path back, except for the last `left` meters.
  void EndPathBack(double left, Time now);

  /// Where the last path back leads; empty if there was none since the explorer was heard.
  std::optional<BackPlace> place() const;

  const FlownPath& flown() const { return flown_; }

 private:
  Options options_;
  FlownPath flown_;
  double heard_at_ = 0.0;  ///< [m] Arc length at which the explorer was last heard.
  Time since_;             ///< When the last message came, or the last path back ended.
  int paths_back_ = 0;     ///< Since the last message.
  double goal_ = 0.0;      ///< [m] Arc length to which the last of them led.
};

}  // namespace thalweg::controller
