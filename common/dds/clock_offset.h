#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

#include "common/base/time.h"

namespace thalweg::dds {

/// Notices that the clocks of a writer's and a reader's machine differ. The least time that a message takes
/// by both clocks is their offset and the delay of the fastest message, which is short.
///
/// Threading: one thread.
class ClockOffset {
 public:
  using SteadyTime = std::chrono::steady_clock::time_point;
  static constexpr Duration kNotable = std::chrono::milliseconds(100);
  static constexpr Duration kPeriod = std::chrono::seconds(5);
  static constexpr int kLeastMessages = 5;

  /// @param age  Age of a message, from when it was written, by the writer's clock, to when it arrived, by
  ///             the reader's.
  /// @return By how much the reader's clock is ahead of the writer's, negative if it is behind, at the end of
  ///         each period in which that is notable.
  std::optional<Duration> Add(Duration age, SteadyTime now) {
    if (messages_ == 0) begin_ = now;
    least_ = messages_ == 0 ? age : std::min(least_, age);
    ++messages_;
    if (now - begin_ < kPeriod || messages_ < kLeastMessages) return std::nullopt;
    messages_ = 0;
    return least_ >= kNotable || least_ <= -kNotable ? std::optional(least_) : std::nullopt;
  }

 private:
  int messages_ = 0;
  Duration least_{};
  SteadyTime begin_;
};

}  // namespace thalweg::dds
