#pragma once

#include <cstdint>
#include <deque>

#include "common/base/time.h"

namespace thalweg::link {

/// How many bytes may be on their way, so that the queues of the link stay short: what is urgent must not
/// wait behind bulk that has left already, and what a full link would drop need not be repeated.
///
/// Follows the delay [Shalunov et al.: LEDBAT, RFC 6817, Sec. 2.4.2]: the round trip beyond the shortest of
/// the last two minutes is time spent in queues; below the target the window grows, above it shrinks. Until
/// the first sign of a queue it doubles in each round trip. Departure: a queue of twice the target takes
/// a third of the window, once a round trip.
///
/// Threading: one thread.
class SendWindow {
 public:
  static constexpr std::size_t kLeast = 6'000;
  static constexpr std::size_t kMost = 128'000;
  static constexpr Duration kTarget = std::chrono::milliseconds(80);  ///< Time in queues.

  bool full() const { return in_flight_ >= window_; }
  /// Whether even what is urgent must wait.
  bool exhausted() const { return in_flight_ >= window_ + kReserve; }

  void OnSent(std::uint64_t sequence, std::size_t bytes, Duration now);
  /// All frames up to `sequence` have arrived.
  void OnAcknowledged(std::uint64_t sequence, Duration now);
  /// Begins a session: what was on its way is no longer.
  void Clear();

  std::size_t window() const { return window_; }
  std::size_t in_flight() const { return in_flight_; }
  /// How long the oldest frame has been on its way; 0 without one.
  Duration OldestAge(Duration now) const { return sent_.empty() ? Duration(0) : now - sent_.front().at; }
  Duration round_trip() const { return round_trip_; }  ///< The last; 0 before the first.

 private:
  static constexpr std::size_t kReserve = 6'000;
  struct Sent {
    std::uint64_t sequence;
    std::size_t bytes;
    Duration at;
  };
  void NoteRoundTrip(Duration round_trip, Duration now);
  void Adapt(std::size_t acknowledged_bytes, Duration now);

  std::deque<Sent> sent_;
  std::size_t in_flight_ = 0;
  std::size_t window_ = 4 * kLeast;
  bool doubling_ = true;
  Duration round_trip_{0};
  // The shortest round trip of this period and of the one before.
  Duration shortest_ = Duration::max();
  Duration shortest_before_ = Duration::max();
  Duration period_begin_{0};
  Duration last_cut_{0};
};

}  // namespace thalweg::link
