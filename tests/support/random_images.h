#pragma once

#include <random>

#include "services/stereo/core/image.h"

namespace thalweg::stereo::test {

inline ByteImage RandomImage(int width, int height, unsigned seed, int channels = 1) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> any(0, 255);
  ByteImage image(width, height, channels);
  for (std::uint8_t& value : image.data()) value = static_cast<std::uint8_t>(any(random));
  return image;
}

/// A random texture with features of several pixels, as a continuous function of position.
class Texture {
 public:
  explicit Texture(unsigned seed) : noise_(RandomImage(kSize, kSize, seed)) {}

  /// Interpolates bilinearly between random values of 88 to 168 on a grid of 3 px.
  double At(double u, double v) const {
    const double x = u / 3.0 + 1000.0 * kSize;
    const double y = v / 3.0 + 1000.0 * kSize;
    const auto i = static_cast<long>(x);
    const auto j = static_cast<long>(y);
    const double a = x - static_cast<double>(i);
    const double b = y - static_cast<double>(j);
    return (1 - b) * ((1 - a) * Grain(i, j) + a * Grain(i + 1, j)) +
           b * ((1 - a) * Grain(i, j + 1) + a * Grain(i + 1, j + 1));
  }

 private:
  static constexpr int kSize = 256;
  double Grain(long i, long j) const {
    return 88.0 + 80.0 / 255.0 * noise_(static_cast<int>(i % kSize), static_cast<int>(j % kSize));
  }
  ByteImage noise_;
};

struct Pair {
  ByteImage left, right;
};

/// A textured surface whose disparity at (u, v) of the left image is slope_u u + slope_v v + offset.
inline Pair PlanePair(int width, int height, double slope_u, double slope_v, double offset, unsigned seed) {
  const Texture texture(seed);
  Pair pair{ByteImage(width, height), ByteImage(width, height)};
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      pair.left(u, v) = static_cast<std::uint8_t>(texture.At(u, v) + 0.5);
      // The left pixel that appears at u in the right image: u_left - d(u_left) = u.
      const double u_left = (u + slope_v * v + offset) / (1.0 - slope_u);
      pair.right(u, v) = static_cast<std::uint8_t>(texture.At(u_left, v) + 0.5);
    }
  }
  return pair;
}

}  // namespace thalweg::stereo::test
