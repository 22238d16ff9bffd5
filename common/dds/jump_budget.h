#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>

namespace thalweg::dds {

/// Bounds what the first sequence numbers in heartbeats cost: a reader of Fast DDS 2.9.1 counts, one by one
/// and with its lock held, from the last that it knows of a writer to the first that the writer still has.
/// That is 90 ns a number here, so that one datagram could stop a process for years. A writer that has sent
/// for days is genuine, however, and must be heard by a reader that comes late.
///
/// A jump of up to a million is free. Longer ones are paid from a common budget; for each writer that is
/// known only the difference to its last jump.
///
/// Threading: any thread.
class JumpBudget {
 public:
  using SteadyTime = std::chrono::steady_clock::time_point;
  using WriterGuid = std::array<std::uint8_t, 16>;
  static constexpr std::int64_t kFree = 1LL << 20;
  static constexpr std::int64_t kMost = 1LL << 24;       ///< 6 days at 30 samples a second; counted in 1.5 s.
  static constexpr std::int64_t kPerSecond = 1LL << 20;  ///< What comes back.

  /// Whether a heartbeat that begins at `first` is to be heard.
  bool Allows(const WriterGuid& writer, std::int64_t first, SteadyTime now) {
    if (first <= kFree) return true;
    const std::lock_guard lock(mutex_);
    const auto known = reached_.find(writer);
    const std::int64_t jump = known == reached_.end() ? first : first - known->second;
    if (jump <= 0) return true;
    if (now > filled_) {
      const double seconds = std::min(std::chrono::duration<double>(now - filled_).count(), 1e3);
      left_ = std::min(kMost, left_ + static_cast<std::int64_t>(seconds * kPerSecond));
      filled_ = now;
    }
    if (jump > left_) return false;
    left_ -= jump;
    // Who is new here has paid at least kFree, so that this takes strangers a second each.
    constexpr std::size_t kMostWriters = 10'000;
    if (known == reached_.end() && reached_.size() >= kMostWriters) reached_.erase(reached_.begin());
    reached_[writer] = first;
    return true;
  }

 private:
  std::mutex mutex_;
  std::map<WriterGuid, std::int64_t> reached_;
  std::int64_t left_ = kMost;
  SteadyTime filled_{};
};

}  // namespace thalweg::dds
