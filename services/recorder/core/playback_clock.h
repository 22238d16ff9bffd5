#pragma once

#include <algorithm>
#include <chrono>

#include "common/base/time.h"

namespace thalweg::recorder {

/// Converts between the time of a recording that is being played and the steady clock of the player. Stands
/// still until the first Resume, and at what is to be played next while the player is late with it.
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
  /// Goes on from `time`, or stands there if it is paused. What is to be played next is no longer known.
  void Seek(Steady now, Time time) {
    position_ = time;
    resumed_ = now;
    next_ = Time::max();
  }
  /// From now on; what was played so far stays played.
  void SetRate(Steady now, double rate) {
    position_ = At(now);
    resumed_ = now;
    rate_ = rate;
  }
  /// @param next  Time of what is to be played next, or was played last while that is not known.
  void SetNext(Time next) { next_ = next; }
  bool running() const { return running_; }
  double rate() const { return rate_; }

  /// Time of the recording at `now`: what lies before it was played.
  Time At(Steady now) const {
    return running_ ? std::min(position_ + FromSeconds(Seconds(now - resumed_) * rate_), next_) : position_;
  }
  /// When `time` of the recording is due, however late the player is. Only while running.
  Steady DueAt(Time time) const { return resumed_ + FromSeconds(Seconds(time - position_) / rate_); }

 private:
  Time position_;  ///< At resumed_, or while it is paused.
  double rate_;
  Steady resumed_;
  bool running_ = false;
  Time next_ = Time::max();
};

}  // namespace thalweg::recorder
