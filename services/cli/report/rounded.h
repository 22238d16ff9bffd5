#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

namespace thalweg::cli {

/// A number with the digits that matter: to 1e-4, so that long lists stay short; null if it is not finite.
inline nlohmann::ordered_json Rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  constexpr double kParts = 1e4;
  return std::round(value * kParts) / kParts;
}

inline nlohmann::ordered_json Rounded(const std::optional<double>& value) {
  return value ? Rounded(*value) : nlohmann::ordered_json(nullptr);
}

inline nlohmann::ordered_json Rounded(const std::vector<double>& values) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const double value : values) list.push_back(Rounded(value));
  return list;
}

}  // namespace thalweg::cli
