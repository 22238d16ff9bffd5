#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <random>

namespace thalweg::simulator {

/// Random draws that are the same with every standard library, unlike std::uniform_real_distribution and its
/// kin. Draw once per statement: compilers choose in which order they evaluate the arguments of a call.
class Chance {
 public:
  explicit Chance(std::uint32_t seed) : random_(seed) {}
  double Between(double low, double high) { return low + (high - low) * (random_() / 4294967296.0); }
  Eigen::Vector2d Within(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
    const double x = Between(low.x(), high.x());
    const double y = Between(low.y(), high.y());
    return {x, y};
  }
  std::size_t Below(std::size_t count) { return random_() % count; }

 private:
  std::mt19937 random_;
};

}  // namespace thalweg::simulator
