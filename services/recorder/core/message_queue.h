#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/time.h"

namespace thalweg::recorder {

/// A message on its way between two threads.
struct QueuedMessage {
  std::size_t topic = 0;  ///< Whatever the two threads number.
  std::uint32_t sequence = 0;
  Time log_time = {}, publish_time = {};
  std::vector<std::uint8_t> payload = {};
};

/// Hands messages from one thread to another; bounded by the bytes of their payloads.
///
/// Threading: any thread may call any function.
class MessageQueue {
 public:
  explicit MessageQueue(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  /// Never waits: returns false, and drops the message, if it does not fit or the queue is closed. A message
  /// fits into an empty queue, however large it is.
  bool TryPush(QueuedMessage message) {
    const std::scoped_lock lock(mutex_);
    if (closed_ || !Fits(message)) return false;
    Append(std::move(message));
    return true;
  }
  /// Waits until the message fits; returns false if the queue is closed.
  bool Push(QueuedMessage message) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return closed_ || Fits(message); });
    if (closed_) return false;
    Append(std::move(message));
    return true;
  }
  /// Waits for a message, at most `patience`. Returns nothing if none came, or none will: see exhausted().
  std::optional<QueuedMessage> Pop(Duration patience) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, patience, [&] { return closed_ || !messages_.empty(); });
    if (messages_.empty()) return std::nullopt;
    QueuedMessage message = std::move(messages_.front());
    messages_.pop_front();
    bytes_ -= message.payload.size();
    changed_.notify_all();
    return message;
  }
  /// No message can be added any more; those in the queue can still be taken.
  void Close() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }
  /// Whether the queue is closed and empty.
  bool exhausted() const {
    const std::scoped_lock lock(mutex_);
    return closed_ && messages_.empty();
  }

 private:
  bool Fits(const QueuedMessage& message) const {
    return messages_.empty() || bytes_ + message.payload.size() <= most_bytes_;
  }
  void Append(QueuedMessage message) {
    bytes_ += message.payload.size();
    messages_.push_back(std::move(message));
    changed_.notify_all();
  }

  const std::size_t most_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<QueuedMessage> messages_;
  std::size_t bytes_ = 0;
  bool closed_ = false;
};

}  // namespace thalweg::recorder
