#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

#include "common/base/median.h"
#include "common/base/time.h"

namespace thalweg {

/// Counts the samples that are missing from a stream, by their stamps: an interval that is several times as
/// long as the median of the last ones lacks those in between.
class StampGaps {
 public:
  /// @return The number missing between this stamp and the one before; 0 until the period is known.
  std::size_t Add(Time stamp) {
    const std::optional<Time> before = std::exchange(last_, stamp);
    if (!before || stamp <= *before) return 0;
    const double interval = Seconds(stamp - *before);
    std::size_t missing = 0;
    if (intervals_.size() >= kLeast) {
      const double period = Median({intervals_.begin(), intervals_.end()});
      if (interval > kNotable * period)
        missing = static_cast<std::size_t>(std::lround(std::min(interval / period, kMost))) - 1;
    }
    intervals_.push_back(interval);
    if (intervals_.size() > kRemembered) intervals_.pop_front();
    return missing;
  }

 private:
  static constexpr std::size_t kLeast = 10;
  static constexpr std::size_t kRemembered = 31;
  static constexpr double kNotable = 1.6;  // cameras skip no half image, but their period varies
  static constexpr double kMost = 1e6;

  std::optional<Time> last_;
  std::deque<double> intervals_;  ///< [s]
};

}  // namespace thalweg
