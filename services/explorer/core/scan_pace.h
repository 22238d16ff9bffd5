#pragma once

#include <cstddef>
#include <deque>

#include "common/base/time.h"

namespace thalweg::explorer {

/// How often scans reach the map, and whether they no longer do: because the sensor, the mapper or the link
/// to it has failed. A robot that moves then would not see what comes into its way. Threading: one thread.
class ScanPace {
 public:
  static constexpr Duration kLeast = std::chrono::seconds(1);  ///< No shorter time is a silence,
  static constexpr int kMissing = 3;                           ///< nor are fewer scans that are missing.
  static constexpr Duration kAtFirst =
      std::chrono::seconds(3);  ///< After the first scan, the pace is not known.
  static constexpr std::size_t kRemembered = 9;

  /// Takes note of a scan that has reached the map.
  void Note(Time now);
  /// Whether none has for too long: kLeast, or kMissing times the median of the last intervals if that is
  /// longer. Never before the first.
  bool Silent(Time now) const;
  /// Adjusts remembered times after the clock jumped back by `back`.
  void ShiftTimes(Duration back);

 private:
  std::deque<Time> noted_;  ///< The last kRemembered + 1.
};

}  // namespace thalweg::explorer
