#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <utility>

#include "services/explorer/core/exploration_loop.h"

namespace thalweg::explorer {

/// What the planner has yet to be given. Bounded, however long a plan takes and whatever arrives meanwhile.
///
/// Threading: any thread may call any function.
class PlannerInbox {
 public:
  using Event = std::function<void(ExplorationLoop&)>;
  static constexpr std::size_t kMostEvents = 20'000;     ///< Some minutes of them.
  static constexpr std::size_t kMostVoxels = 5'000'000;  ///< 80 MB of changes.

  /// Adds an event that changes so many voxels of the map. Returns false if it does not fit; into an empty
  /// inbox fits any.
  bool TryPush(Event event, std::size_t voxels = 0) {
    {
      const std::scoped_lock lock(mutex_);
      const bool full = events_.size() >= kMostEvents || voxels_ + voxels > kMostVoxels;
      if (full && !events_.empty()) return false;
      events_.push_back(std::move(event));
      voxels_ += voxels;
    }
    news_.notify_one();
    return true;
  }

  /// Waits for events and takes all of them; none if stopped.
  std::deque<Event> Take(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    news_.wait(lock, stop, [this] { return !events_.empty(); });
    voxels_ = 0;
    return std::exchange(events_, {});
  }

  bool empty() const {
    const std::scoped_lock lock(mutex_);
    return events_.empty();
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable_any news_;
  std::deque<Event> events_;
  std::size_t voxels_ = 0;  ///< In all events.
};

}  // namespace thalweg::explorer
