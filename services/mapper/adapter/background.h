#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace thalweg::mapper {

/// Runs one task at a time on a thread of its own, for work that would hold up the service and can fail
/// without it: what a task throws is logged.
/// Threading: all functions on the owner's thread; the destructor waits for the task.
class Background {
 public:
  Background();

  bool busy() const;
  /// Only while not busy().
  void Run(std::function<void()> task);
  void Wait();  ///< Until not busy().

 private:
  void Work(const std::stop_token& stop);

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::function<void()> task_;  ///< Until it is done.
  std::jthread thread_;         ///< Last: ends before what it uses.
};

}  // namespace thalweg::mapper
