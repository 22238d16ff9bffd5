#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace thalweg {

/// Runs one task at a time on its own thread: work that would block the service, and whose failure the
/// service survives. An exception that a task throws is logged.
///
/// Threading: call all functions on the owner's thread; the destructor waits for the running task.
class Background {
 public:
  Background();

  bool busy() const;
  /// Precondition: not busy().
  void Run(std::function<void()> task);
  void Wait();  ///< Returns once not busy().

 private:
  void Work(const std::stop_token& stop);

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::function<void()> task_;  ///< The running task; empty when idle.
  std::jthread thread_;         ///< Last, so that it is joined before the members it uses are destroyed.
};

}  // namespace thalweg
