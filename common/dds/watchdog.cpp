#include "common/dds/watchdog.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace thalweg::dds {

bool StallDetector::Look(std::uint64_t steps, bool busy, Duration since_last_look) {
  const bool moves = !busy || steps != steps_;
  steps_ = steps;
  if (moves) {
    stalled_ = Duration::zero();
  } else if (since_last_look <= 2 * period_) {
    stalled_ += since_last_look;
  }
  return stalled_ >= limit_;
}

Watchdog::Watchdog(Duration limit, std::function<void(const std::string&)> on_stall)
    : limit_(limit),
      on_stall_(std::move(on_stall)),
      thread_([this](const std::stop_token& stop) { Run(stop); }) {}

void Watchdog::Run(const std::stop_token& stop) {
  constexpr Duration kShortest = std::chrono::milliseconds(10);
  constexpr Duration kLongest = std::chrono::seconds(1);
  const Duration period = std::clamp<Duration>(limit_ / 10, kShortest, kLongest);
  StallDetector detector(limit_, period);
  auto last = std::chrono::steady_clock::now();
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    wake_.wait_for(lock, stop, period, [] { return false; });
    const auto now = std::chrono::steady_clock::now();
    const char* const what = doing_.load(std::memory_order_relaxed);
    if (detector.Look(steps_.load(std::memory_order_relaxed), what != nullptr,
                      now - std::exchange(last, now))) {
      return on_stall_(what);
    }
  }
}

}  // namespace thalweg::dds
