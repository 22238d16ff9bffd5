#pragma once

#include <cstdint>

namespace thalweg {

/// Maps integers to natural numbers by magnitude, so that small ones are short as varints:
/// 0, -1, 1, -2, 2, ... to 0, 1, 2, 3, 4, ...
constexpr std::uint64_t ZigZag(std::int64_t value) {
  return (static_cast<std::uint64_t>(value) << 1U) ^ static_cast<std::uint64_t>(value >> 63);
}
/// The inverse of ZigZag.
constexpr std::int64_t FromZigZag(std::uint64_t value) {
  return static_cast<std::int64_t>(value >> 1U) ^ -static_cast<std::int64_t>(value & 1U);
}

}  // namespace thalweg
