#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg::simulator {

/// What the cameras capture at one instant.
struct Shot {
  Time stamp;
  RigidTransform T_WB;
  bool depth = false;
  bool stereo = false;
};

/// Captures one shot at a time on a thread of its own, so that rendering does not hold up commands.
/// Threading: Take and busy may be called from any thread; `capture` runs on the object's own thread.
class CameraThread {
 public:
  explicit CameraThread(std::function<void(const Shot&)> capture);

  bool busy() const;
  /// Must only be called while not busy().
  void Take(const Shot& shot);

 private:
  void Run(const std::stop_token& stop);

  std::function<void(const Shot&)> capture_;
  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  std::optional<Shot> shot_;  ///< Set until the shot has been captured.
  std::jthread thread_;       ///< Declared last, so that it stops before the members it uses are destroyed.
};

}  // namespace thalweg::simulator
