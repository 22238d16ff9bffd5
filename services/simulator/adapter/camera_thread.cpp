#include "services/simulator/adapter/camera_thread.h"

#include "common/base/check.h"

namespace thalweg::simulator {

CameraThread::CameraThread(std::function<void(const Shot&)> capture)
    : capture_(std::move(capture)), thread_([this](const std::stop_token& stop) { Run(stop); }) {}

bool CameraThread::busy() const {
  const std::lock_guard lock(mutex_);
  return shot_.has_value();
}

void CameraThread::Take(const Shot& shot) {
  {
    const std::lock_guard lock(mutex_);
    THALWEG_CHECK(!shot_.has_value());
    shot_ = shot;
  }
  wake_.notify_one();
}

void CameraThread::Run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (wake_.wait(lock, stop, [this] { return shot_.has_value(); })) {
    const Shot shot = *shot_;
    lock.unlock();
    capture_(shot);
    lock.lock();
    shot_.reset();
  }
}

}  // namespace thalweg::simulator
