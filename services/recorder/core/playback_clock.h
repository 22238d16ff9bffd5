#pragma once

#include <chrono>

#include "common/base/time.h"

namespace thalweg::recorder {

/// Converts between the time of a recording that is being played and the steady clock of the player. Stands
/// still until the first Resume.
class PlaybackClock {
 public:
  using Steady = std::chrono::steady_clock::time_point;

  /// @param start  Time of the recording at which it begins.
  /// @param rate   Seconds of the recording per second; > 0.
  PlaybackClock(Time start, double rate) : position_(start), rate_(rate) {}

  void Resume(Steady now) {
    if (!running_) resumed_ = now;
    running_ = true;
  }
  void Pause(Steady now) {
    position_ = At(now);
    running_ = false;
  }
  bool running() const { return running_; }

  /// Time of the recording at `now`.
  Time At(Steady now) const {
    return running_ ? position_ + FromSeconds(Seconds(now - resumed_) * rate_) : position_;
  }
  /// When `time` of the recording is due. Only while running.
  Steady DueAt(Time time) const { return resumed_ + FromSeconds(Seconds(time - position_) / rate_); }

 private:
  Time position_;  ///< When it was last resumed, or while it is paused.
  double rate_;
  Steady resumed_;
  bool running_ = false;
};

}  // namespace thalweg::recorder
