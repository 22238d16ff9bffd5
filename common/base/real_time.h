#pragma once

#include <sched.h>

namespace thalweg {

/// While it lives, the calling thread runs before all that has no real-time priority, and so wakes on time
/// however busy the machine is. Without the right to it (root, or a limit of rtprio) nothing changes. Threads
/// that this one starts have the usual priority.
class RealTime {
 public:
  RealTime() {
    const sched_param lowest{.sched_priority = 1};
    granted_ = sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &lowest) == 0;
  }
  ~RealTime() {
    const sched_param usual{.sched_priority = 0};
    if (granted_) sched_setscheduler(0, SCHED_OTHER | SCHED_RESET_ON_FORK, &usual);
  }
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

  bool granted() const { return granted_; }

 private:
  bool granted_;
};

}  // namespace thalweg
