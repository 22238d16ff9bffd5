#include "common/service/background.h"

#include <spdlog/spdlog.h>

#include <exception>

#include "common/base/check.h"

namespace thalweg {

Background::Background() : thread_([this](const std::stop_token& stop) { Work(stop); }) {}

bool Background::busy() const {
  const std::lock_guard lock(mutex_);
  return static_cast<bool>(task_);
}

void Background::Run(std::function<void()> task) {
  {
    const std::lock_guard lock(mutex_);
    THALWEG_CHECK(!task_);
    task_ = std::move(task);
  }
  changed_.notify_all();
}

void Background::Wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !task_; });
}

void Background::Work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return static_cast<bool>(task_); })) {
    lock.unlock();
    try {
      task_();
    } catch (const std::exception& error) {
      spdlog::error("background task failed: {}", error.what());
    }
    lock.lock();
    task_ = nullptr;
    changed_.notify_all();
  }
}

}  // namespace thalweg
