#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "common/base/time.h"

namespace thalweg::dds {

/// Decides from regular looks at a thread's progress whether it stands still. What counts is the time in
/// which the thread could have worked: a look that comes much later than the one before was held up itself,
/// since the whole process was stopped or the machine was busy.
class StallDetector {
 public:
  /// @param limit   Time without progress that counts as standing still.
  /// @param period  Time between looks.
  StallDetector(Duration limit, Duration period) : limit_(limit), period_(period) {}

  /// @param steps  Changes with each step of the thread.
  /// @param busy   Whether it works on something, rather than waiting for work.
  /// @param since_last_look  As measured.
  /// @return Whether it stands still.
  bool Look(std::uint64_t steps, bool busy, Duration since_last_look);

 private:
  Duration limit_;
  Duration period_;
  std::uint64_t steps_ = 0;
  Duration stalled_{0};
};

/// Watches one thread, from a thread of its own, and reports once if it stands still.
class Watchdog {
 public:
  /// @param limit     Time without progress that counts as standing still; > 0.
  /// @param on_stall  Called on the watchdog's thread with what the watched thread does, in words.
  Watchdog(Duration limit, std::function<void(const std::string&)> on_stall);

  /// The watched thread begins something else.
  /// @param what  In words, must outlive the watchdog; null = it waits for work.
  void Begin(const char* what) {
    doing_.store(what, std::memory_order_relaxed);
    steps_.fetch_add(1, std::memory_order_relaxed);
  }

 private:
  void Run(const std::stop_token& stop);

  Duration limit_;
  std::function<void(const std::string&)> on_stall_;
  std::atomic<const char*> doing_ = nullptr;
  std::atomic<std::uint64_t> steps_ = 0;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;  ///< Declared last, because it uses everything above.
};

}  // namespace thalweg::dds
