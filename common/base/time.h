#pragma once

#include <chrono>

namespace thalweg {

using Duration = std::chrono::nanoseconds;

/// A point in time on the run's clock: the system's, or the simulator's (`/clock`). On the wire it is the ROS
/// header stamp. Core code never reads a clock; its caller passes the time in.
using Time = std::chrono::sys_time<Duration>;

/// A stamp this much earlier than the previous one means that the clock was restarted; less is messages out
/// of order.
inline constexpr Duration kClockRestart = std::chrono::seconds(1);

inline double Seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

inline Duration FromSeconds(double seconds) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

}  // namespace thalweg
