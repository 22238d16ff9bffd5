#include "services/link/core/send_window.h"

#include <algorithm>

namespace thalweg::link {

void SendWindow::OnSent(std::uint64_t sequence, std::size_t bytes, Duration now) {
  sent_.push_back({sequence, bytes, now});
  in_flight_ += bytes;
}

void SendWindow::OnAcknowledged(std::uint64_t sequence, Duration now) {
  std::size_t bytes = 0;
  Duration newest{0};
  while (!sent_.empty() && sent_.front().sequence <= sequence) {
    bytes += sent_.front().bytes;
    newest = sent_.front().at;
    sent_.pop_front();
  }
  if (bytes == 0) return;
  const bool was_used = 2 * in_flight_ > window_;
  in_flight_ -= bytes;
  NoteRoundTrip(now - newest, now);
  if (was_used) Adapt(bytes, now);  // a window that nobody fills says nothing about the link
}

void SendWindow::Clear() {
  sent_.clear();
  in_flight_ = 0;
}

void SendWindow::NoteRoundTrip(Duration round_trip, Duration now) {
  constexpr Duration kPeriod = std::chrono::minutes(1);
  round_trip_ = round_trip;
  if (now - period_begin_ > kPeriod) {
    shortest_before_ = shortest_;
    shortest_ = Duration::max();
    period_begin_ = now;
  }
  shortest_ = std::min(shortest_, round_trip);
}

void SendWindow::Adapt(std::size_t acknowledged_bytes, Duration now) {
  const Duration queueing = round_trip_ - std::min(shortest_, shortest_before_);
  const double off = std::clamp(Seconds(kTarget - queueing) / Seconds(kTarget), -1.0, 1.0);
  const auto bytes = static_cast<double>(acknowledged_bytes);
  auto window = static_cast<double>(window_);
  if (doubling_ && queueing < kTarget / 2) {
    window += bytes;
  } else if (queueing > 2 * kTarget) {
    doubling_ = false;
    if (now - last_cut_ > round_trip_) {
      window *= 2.0 / 3.0;
      last_cut_ = now;
    }
  } else {
    doubling_ = false;
    constexpr double kGain = 1200.0;  // [byte] in a round trip
    window += kGain * off * bytes / window;
  }
  window_ =
      static_cast<std::size_t>(std::clamp(window, static_cast<double>(kLeast), static_cast<double>(kMost)));
}

}  // namespace thalweg::link
