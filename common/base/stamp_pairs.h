#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include "common/base/time.h"

namespace thalweg {

/// Pairs the images that two cameras took at the same time, in whichever order they arrive. A value older
/// than the last pair is dropped and counted, and so is the oldest of more than `capacity` that wait for
/// their counterpart.
template <class T>
class StampPairs {
 public:
  explicit StampPairs(std::size_t capacity = 4) : capacity_(capacity) {}

  /// @return The pair (left, right) if this was the missing half.
  std::optional<std::pair<T, T>> AddLeft(Time stamp, T value) {
    return Add(stamp, std::move(value), left_, right_,
               [](T own, T other) { return std::pair<T, T>(std::move(own), std::move(other)); });
  }
  std::optional<std::pair<T, T>> AddRight(Time stamp, T value) {
    return Add(stamp, std::move(value), right_, left_,
               [](T own, T other) { return std::pair<T, T>(std::move(other), std::move(own)); });
  }

  /// Number of values dropped since the last call.
  std::size_t TakeDropped() { return std::exchange(dropped_, 0); }
  /// Discards everything if `stamp`, of the value about to be added, is so much older than the newest one
  /// that the clock must have been restarted.
  /// @return Whether it was.
  bool ClearIfRestarted(Time stamp) {
    const bool restarted = newest_ && *newest_ - stamp >= kClockRestart;
    if (restarted) {
      left_.clear();
      right_.clear();
      last_.reset();
      newest_.reset();
    }
    newest_ = std::max(newest_.value_or(stamp), stamp);
    return restarted;
  }

 private:
  using Waiting = std::map<Time, T>;

  template <class MakePair>
  std::optional<std::pair<T, T>> Add(Time stamp, T value, Waiting& own, Waiting& other,
                                     MakePair&& make_pair) {
    if (last_ && stamp <= *last_) {
      ++dropped_;
      return std::nullopt;
    }
    const auto match = other.find(stamp);
    if (match == other.end()) {
      if (!own.insert_or_assign(stamp, std::move(value)).second) ++dropped_;
      if (own.size() > capacity_) {
        own.erase(own.begin());
        ++dropped_;
      }
      return std::nullopt;
    }
    auto pair = make_pair(std::move(value), std::move(match->second));
    last_ = stamp;
    dropped_ += DropUpTo(stamp, own) + DropUpTo(stamp, other) - 1;
    return pair;
  }
  static std::size_t DropUpTo(Time stamp, Waiting& waiting) {
    const std::size_t before = waiting.size();
    waiting.erase(waiting.begin(), waiting.upper_bound(stamp));
    return before - waiting.size();
  }

  std::size_t capacity_;
  Waiting left_, right_;
  std::optional<Time> last_;    ///< Stamp of the last pair.
  std::optional<Time> newest_;  ///< Newest stamp since the clock was started.
  std::size_t dropped_ = 0;
};

}  // namespace thalweg
