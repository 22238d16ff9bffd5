#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <functional>

#include "common/base/time.h"
#include "common/dds/health.h"
#include "common/dds/topics.h"

namespace thalweg::dds {

/// The timers of a bus, on the machine's steady clock and on that of the topic `clock`. A timer that is late
/// fires once, not once per missed period.
///
/// Threading: the spinning thread, but for topic_now().
class Timers {
 public:
  using SteadyTime = std::chrono::steady_clock::time_point;
  /// @param doing  Called before each handler, for the watchdog.
  Timers(Health& health, std::function<void(const char* what)> doing)
      : health_(health), doing_(std::move(doing)) {}

  void AddWall(Duration period, std::function<void()> handler);
  void AddTopic(Duration period, std::function<void()> handler);
  /// Sets the topic's clock by a message of its.
  void OnClock(const rosgraph_msgs::msg::Clock& message);
  /// Sets the topic's clock. If it jumps back, since the simulator was restarted, timers restart from there.
  void SetTopicNow(Time now);

  void RunDue();            ///< Handlers may add timers.
  SteadyTime Next() const;  ///< When the next one on the steady clock is due.
  Time topic_now() const { return Time{Duration(topic_now_)}; }  ///< The epoch until the first message.

 private:
  template <class Moment>
  struct Timer {
    Duration period;
    std::function<void()> handler;
    Moment due;

    /// Whether the timer is due; if so, schedules it for its next beat after `now`.
    bool Take(Moment now) {
      if (now < due) return false;
      due += ((now - due) / period + 1) * period;
      return true;
    }
  };

  Health& health_;
  std::function<void(const char* what)> doing_;
  std::deque<Timer<SteadyTime>> wall_timers_;
  std::deque<Timer<Time>> topic_timers_;
  std::atomic<Duration::rep> topic_now_ = 0;
  bool topic_clock_runs_ = false;
  SteadyTime last_restart_;  ///< When the topic's clock last jumped back.
};

}  // namespace thalweg::dds
