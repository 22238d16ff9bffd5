#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg::simulator {

/// What a camera is to capture.
struct Shot {
  Time stamp;
  RigidTransform T_WB;
  bool depth = false;
  bool stereo = false;
};

/// Captures one shot at a time on a thread of its own, so that rendering does not hold up commands.
/// Threading: Take and busy on any thread; `capture` runs on the own thread.
class CameraThread {
 public:
  explicit CameraThread(std::function<void(const Shot&)> capture);

  bool busy() const;
  /// Only while not busy().
  void Take(const Shot& shot);

 private:
  void Run(const std::stop_token& stop);

  std::function<void(const Shot&)> capture_;
  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  std::optional<Shot> shot_;  ///< Until it is captured.
  std::jthread thread_;       ///< Last: ends before what it uses.
};

}  // namespace thalweg::simulator
