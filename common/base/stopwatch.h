#pragma once

#include <chrono>

namespace thalweg {

/// How long a piece of work took, for statistics only: nothing may be decided by it.
class Stopwatch {
 public:
  double Milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace thalweg
