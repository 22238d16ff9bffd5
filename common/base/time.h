#pragma once

#include <chrono>

namespace thalweg {

using Duration = std::chrono::nanoseconds;

/// A moment on the run's clock: the system's, or the simulator's (`/clock`). On the wire it is the ROS
/// header stamp. Core code never asks for the time; it is handed in.
using Time = std::chrono::sys_time<Duration>;

/// Stamps that go back by so much come from a clock that began anew; less is the disorder of messages.
inline constexpr Duration kClockBeganAnew = std::chrono::seconds(1);

inline double Seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

inline Duration FromSeconds(double seconds) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

}  // namespace thalweg
