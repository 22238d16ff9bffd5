#pragma once

#include <chrono>

#include "common/base/time.h"

namespace thalweg::recorder {

/// Converts between the time of a recording that is being played and the steady clock of the player. Stands
/// still until the first Resume.
class PlaybackClock {
 public:
  using Steady = std::chrono::steady_clock::time_point;

  // Rates beyond these serve nobody, and times divided by them would not fit their type.
  static constexpr double kSlowest = 1e-3;
  static constexpr double kFastest = 1e3;
  static constexpr bool IsRate(double rate) { return rate >= kSlowest && rate <= kFastest; }

  /// @param start  Time of the recording at which it begins.
  /// @param rate   Seconds of the recording per second; see IsRate.
  PlaybackClock(Time start, double rate) : position_(start), rate_(rate) {}

  void Resume(Steady now) {
    if (!running_) resumed_ = now;
    running_ = true;
  }
  void Pause(Steady now) {
    position_ = At(now);
    running_ = false;
  }
  /// Goes on from `time`, or stands there if it is paused.
  void Seek(Steady now, Time time) {
    position_ = time;
    resumed_ = now;
  }
  /// From now on; what was played so far stays played.
  void SetRate(Steady now, double rate) {
    Seek(now, At(now));
    rate_ = rate;
  }
  bool running() const { return running_; }
  double rate() const { return rate_; }

  /// Time of the recording at `now`.
  Time At(Steady now) const {
    return running_ ? position_ + FromSeconds(Seconds(now - resumed_) * rate_) : position_;
  }
  /// When `time` of the recording is due. Only while running.
  Steady DueAt(Time time) const { return resumed_ + FromSeconds(Seconds(time - position_) / rate_); }

 private:
  Time position_;  ///< At resumed_, or while it is paused.
  double rate_;
  Steady resumed_;
  bool running_ = false;
};

}  // namespace thalweg::recorder
