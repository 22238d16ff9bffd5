#pragma once

#include <chrono>

namespace thalweg {

/// Measures how long an operation takes, for statistics only: no decision may depend on it.
class Stopwatch {
 public:
  double Milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace thalweg
