#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "common/geometry/point_cloud.h"

namespace thalweg {

/// The color of a height in pictures of the map: blue at the bottom, over green, to orange at the top.
/// @param share  0 = bottom, 1 = top; limited to that.
inline Rgb HeightColor(float share) {
  constexpr std::array<std::array<float, 3>, 6> kRamp = {
      {{43, 58, 143}, {35, 120, 181}, {47, 179, 163}, {166, 207, 91}, {243, 193, 75}, {240, 118, 74}}};
  const float at = std::clamp(share, 0.0F, 0.9999F) * (kRamp.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const auto mixed = [&](std::size_t k) {
    return static_cast<std::uint8_t>(
        std::lround(std::lerp(kRamp[low][k], kRamp[low + 1][k], at - static_cast<float>(low))));
  };
  return {.r = mixed(0), .g = mixed(1), .b = mixed(2)};
}

}  // namespace thalweg
